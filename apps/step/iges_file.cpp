// SPDX-License-Identifier: GPL-3.0-or-later
#include "iges_file.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESData_GlobalSection.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Static.hxx>
#include <NCollection_DataMap.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <string_view>

#include "base/text.hpp"
#include "step_progress.hpp"

namespace millpose {
namespace {

constexpr double kSewn = 0.01;   // mm
constexpr size_t kColumns = 72;  // of a line; behind them its section's letter and number

// Lines of each section, as the last line of the file counts them: OpenCASCADE reads a file that was cut off
// as a smaller part.
void RefuseCutOff(std::string_view bytes) {
  std::map<char, double> lines;
  std::string_view last;
  while (!bytes.empty()) {
    const std::string_view line = bytes.substr(0, bytes.find('\n'));
    bytes.remove_prefix(std::min(line.size() + 1, bytes.size()));
    if (line.size() <= kColumns || lines.contains('T')) continue;
    ++lines[line[kColumns]];
    last = line;
  }
  if (!lines.contains('T'))
    throw std::runtime_error("the IGES file is cut off: its last section (T) is missing");
  for (size_t i = 0; i < 4; ++i) {  // S0000001G0000004D0000042P0000099
    const std::string_view stated = last.substr(8 * i, 8);
    std::string_view digits = stated.substr(1);
    while (digits.starts_with(' ')) digits.remove_prefix(1);
    const std::optional<double> count = ParseNumber(digits);
    if (!count || lines[stated[0]] != *count)
      throw std::runtime_error(
          fmt::format("the IGES file is damaged: its last line states \"{}\", and section "
                      "{} has {} lines",
                      stated, stated[0], lines[stated[0]]));
  }
}

// OpenCASCADE reads IGES from named files alone: one in memory, that nobody else sees and no end leaves
// behind.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view bytes) : file_(::memfd_create("part.igs", MFD_CLOEXEC)) {
    while (file_ >= 0 && !bytes.empty()) {
      const ssize_t count = ::write(file_, bytes.data(), bytes.size());
      if (count <= 0) throw std::runtime_error("the IGES file does not fit into memory");
      bytes.remove_prefix(static_cast<size_t>(count));
    }
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { ::close(file_); }
  std::string Path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

CadUnit UnitOf(const IGESData_GlobalSection& global) {
  static const std::array<CadUnit, 12> kByFlag{{{"", 1, false},
                                                {"inch", 25.4, true},
                                                {"millimetre", 1, true},
                                                {"", 1, false},
                                                {"foot", 304.8, false},
                                                {"mile", 1609344, false},
                                                {"metre", 1000, true},
                                                {"kilometre", 1e6, false},
                                                {"mil", 0.0254, false},
                                                {"micrometre", 1e-3, false},
                                                {"centimetre", 10, true},
                                                {"microinch", 2.54e-5, false}}};
  const int flag = global.UnitFlag();
  if (flag >= 0 && flag < static_cast<int>(kByFlag.size()) && kByFlag[flag].factor > 0 &&
      !kByFlag[flag].name.empty())
    return kByFlag[flag];
  throw std::runtime_error(
      fmt::format("the IGES file states unit flag {}; read are 1 (in), 2 (mm), 4 to 11", flag));
}

using IgesFaces = NCollection_DataMap<Handle(TopoDS_TShape), Handle(IGESData_IGESEntity)>;

// The entity of the file that each face comes from; `failed` counts trimmed and bounded surfaces and faces of
// solids of which nothing came.
IgesFaces EntitiesOf(const IGESControl_Reader& reader, int& failed) {
  IgesFaces entities;
  const Handle(IGESData_IGESModel) model = reader.IGESModel();
  const Handle(Transfer_TransientProcess) process = reader.WS()->TransferReader()->TransientProcess();
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(IGESData_IGESEntity) entity = model->Entity(i);
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process, entity);
    const int type = entity->TypeNumber();
    if (shape.IsNull() && (type == 143 || type == 144)) ++failed;
    if (shape.IsNull()) continue;
    for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next())
      if (shape.ShapeType() == TopAbs_FACE || !entities.IsBound(it.Current().TShape()))
        entities.Bind(it.Current().TShape(), entity);
  }
  return entities;
}

SourceFace Described(const IgesFaces& entities, const Handle(IGESData_IGESModel) & model,
                     const TopoDS_Face& face, const Handle(TopoDS_TShape) & as_read) {
  SourceFace source = DescribeFace(face);
  if (!entities.IsBound(as_read)) return source;
  const Handle(IGESData_IGESEntity)& entity = entities.Find(as_read);
  source.id = fmt::format("#{}", model->DNum(entity));
  if (entity->HasName()) source.name = entity->NameValue()->ToCString();
  return source;
}

/// The solids of a shape as they are and, of all other faces, what they make where they are sewn; `as_read`
/// has what sewn faces were before.
TopoDS_Shape Sewn(const TopoDS_Shape& shape,
                  NCollection_DataMap<Handle(TopoDS_TShape), Handle(TopoDS_TShape)>& as_read) {
  BRep_Builder builder;
  TopoDS_Compound whole;
  builder.MakeCompound(whole);
  for (TopExp_Explorer it(shape, TopAbs_SOLID); it.More(); it.Next()) builder.Add(whole, it.Current());
  BRepBuilderAPI_Sewing sewing(kSewn);
  std::vector<TopoDS_Shape> loose;
  for (TopExp_Explorer it(shape, TopAbs_FACE, TopAbs_SOLID); it.More(); it.Next()) {
    loose.push_back(it.Current());
    sewing.Add(it.Current());
  }
  if (loose.empty()) return whole;
  sewing.Perform();
  for (const TopoDS_Shape& face : loose) as_read.Bind(sewing.ModifiedSubShape(face).TShape(), face.TShape());
  const TopoDS_Shape sewn = sewing.SewedShape();
  for (TopExp_Explorer it(sewn, TopAbs_SHELL); it.More(); it.Next())
    if (BRep_Tool::IsClosed(it.Current()))
      builder.Add(whole, BRepBuilderAPI_MakeSolid(TopoDS::Shell(it.Current())).Solid());
    else
      builder.Add(whole, it.Current());
  for (TopExp_Explorer it(sewn, TopAbs_FACE, TopAbs_SHELL); it.More(); it.Next())
    builder.Add(whole, it.Current());
  return whole;
}

}  // namespace

CadModel ReadIgesModel(const std::string& bytes) {
  RefuseCutOff(bytes);
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  const MemoryFile file(bytes);
  IGESControl_Reader reader;
  TellPercent(0);
  if (reader.ReadFile(file.Path().c_str()) != IFSelect_RetDone)
    throw std::runtime_error("the IGES file cannot be parsed");
  TellPercent(kParsed);
  const Handle(StepProgress) progress = new StepProgress(kParsed, kTransferred);
  if (reader.TransferRoots(progress->Start()) == 0)
    throw std::runtime_error("the IGES file holds no shape that can be read");
  int failed = 0;
  const IgesFaces entities = EntitiesOf(reader, failed);
  NCollection_DataMap<Handle(TopoDS_TShape), Handle(TopoDS_TShape)> as_read;
  CadModel model{
      "IGES", Sewn(reader.OneShape(), as_read), UnitOf(reader.IGESModel()->GlobalSection()), {}, {}, {}};
  for (TopExp_Explorer it(model.shape, TopAbs_FACE); it.More(); it.Next()) {
    const Handle(TopoDS_TShape) now = it.Current().TShape();
    model.faces.push_back(Described(entities, reader.IGESModel(), TopoDS::Face(it.Current()),
                                    as_read.IsBound(now) ? as_read.Find(now) : now));
  }
  model.bodies = BodiesOf(model.shape);
  if (failed > 0)
    model.notes.push_back(fmt::format("{} of the IGES file's surfaces could not be read and {} missing",
                                      failed, failed == 1 ? "is" : "are"));
  return model;
}

}  // namespace millpose
