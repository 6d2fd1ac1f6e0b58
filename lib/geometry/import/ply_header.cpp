// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/ply_header.hpp"

#include "base/error.hpp"
#include "geometry/import/text_scanner.hpp"

namespace millpose {
namespace {

PlyType TypeOf(TextScanner& scanner) {
  static const std::map<std::string_view, PlyType> types{
      {"char", PlyType::kInt8},     {"int8", PlyType::kInt8},     {"uchar", PlyType::kUint8},
      {"uint8", PlyType::kUint8},   {"short", PlyType::kInt16},   {"int16", PlyType::kInt16},
      {"ushort", PlyType::kUint16}, {"uint16", PlyType::kUint16}, {"int", PlyType::kInt32},
      {"int32", PlyType::kInt32},   {"uint", PlyType::kUint32},   {"uint32", PlyType::kUint32},
      {"float", PlyType::kFloat},   {"float32", PlyType::kFloat}, {"double", PlyType::kDouble},
      {"float64", PlyType::kDouble}};
  const std::string_view word = scanner.Next();
  const auto found = types.find(word);
  if (found == types.end())
    throw InputError(scanner.place(), fmt::format("\"{}\" is no PLY type", word.substr(0, 40)));
  return found->second;
}

PlyFormat FormatOf(TextScanner& scanner) {
  const std::string_view word = scanner.Next();
  if (word == "ascii") return PlyFormat::kAscii;
  if (word == "binary_little_endian") return PlyFormat::kLittleEndian;
  if (word == "binary_big_endian") return PlyFormat::kBigEndian;
  throw InputError(scanner.place(),
                   fmt::format("\"{}\" is no PLY format; there are ascii, binary_little_endian, "
                               "binary_big_endian",
                               word.substr(0, 40)));
}

PlyProperty PropertyOf(TextScanner& scanner) {
  PlyProperty property;
  property.list = scanner.Accept("list");
  if (property.list) {
    property.count_type = TypeOf(scanner);
    if (property.count_type >= PlyType::kFloat)
      throw InputError(scanner.place(), "the length of a list must be a whole number");
  }
  property.type = TypeOf(scanner);
  property.name = scanner.Next().substr(0, 100);
  return property;
}

// Bytes that one record of the element takes at least.
long long LeastSize(const PlyElement& element, PlyFormat format) {
  long long size = 0;
  for (const PlyProperty& property : element.properties)
    size += format == PlyFormat::kAscii ? 2 : SizeOf(property.list ? property.count_type : property.type);
  return size;
}

}  // namespace

int SizeOf(PlyType type) {
  constexpr std::array<int, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<size_t>(type)];
}

PlyHeader ReadPlyHeader(std::string_view bytes, const std::string& name) {
  TextScanner scanner(bytes, name);
  scanner.Expect("ply");
  PlyHeader header;
  std::vector<SourceLocation> count_places;
  for (;;) {
    const std::string_view word = scanner.Next();
    if (word == "end_header") break;
    if (word == "format") {
      header.format = FormatOf(scanner);
    } else if (word == "element") {
      PlyElement& element = header.elements.emplace_back();
      element.name = scanner.Next().substr(0, 100);
      element.count = scanner.Integer(0, 1LL << 31, "the number of elements");
      count_places.push_back(scanner.place());
    } else if (word == "property") {
      if (header.elements.empty())
        throw InputError(scanner.place(), "a property stands before the first element");
      header.elements.back().properties.push_back(PropertyOf(scanner));
    } else if (word != "comment" && word != "obj_info") {
      throw InputError(scanner.place(), word.empty() ? "the header has no \"end_header\""
                                                     : fmt::format("\"{}\" does not belong into a PLY header",
                                                                   word.substr(0, 40)));
    }
    scanner.SkipLine();
  }
  scanner.SkipLine();
  header.size = scanner.position();
  header.lines = scanner.line() - 1;
  const auto rest = static_cast<long long>(bytes.size() - header.size) + 1;  // the last line may lack its end
  for (size_t i = 0; i < header.elements.size(); ++i) {
    const PlyElement& element = header.elements[i];
    const long long least = LeastSize(element, header.format);
    if (element.count > 0 && (least == 0 || element.count > rest / least))
      throw InputError(count_places[i],
                       fmt::format("{} elements \"{}\" do not fit into the {} bytes behind the header",
                                   element.count, element.name, rest - 1));
  }
  return header;
}

}  // namespace millpose
