// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/engagement_options.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "job/assemble.hpp"
#include "job/bent_part.hpp"
#include "job/raw_stock.hpp"
#include "toolpath/engagement/cutting_material.hpp"
#include "toolpath/stock/taken_off.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {
namespace {

constexpr double kBeforeTolerance = 0.01;  // mm, of what operations before have taken off
constexpr double kSameShare = 0.05;        // share by which given and worked out may differ

CuttingMaterial MaterialOf(const CuttingSettings& cutting) {
  if (cutting.kc11 > 0) return {cutting.material, cutting.kc11, cutting.mc, "job"};
  if (const CuttingMaterial* known = FindCuttingMaterial(cutting.material)) return *known;
  throw InputError({}, "process.cutting.material: " + UnknownMaterial(cutting.material));
}

class CuttingReader {
 public:
  CuttingReader(const JobInputs& inputs, const Mesh& mesh)
      : inputs_(inputs), job_(inputs.job), from_(*inputs.job.cutting), mesh_(mesh) {}

  EngagementOptions Read() {
    EngagementOptions options;
    options.edge = Edge();
    options.spindle_speed = job_.spindle_speed;
    options.up_factor = job_.force_factors.up;
    options.down_factor = job_.force_factors.down;
    options.slot_factor = job_.force_factors.slot;
    if (job_.spindle_speed <= 0) Add("process.spindle_rpm: given 0; process.cutting needs it above 0");
    const std::optional<double> point = job_.toolpath.strategy->DrillPoint();
    if (point) return ReadDrill(*point, std::move(options));
    const double top = ReadDepth(options);
    ReadWidth(options);
    if (!options.stated) CheckStock();
    if (!problems_.empty()) throw InputError(std::move(problems_));
    if (!options.stated) options.stock = job_.stock == Standing::kMesh ? StockMesh() : Raised(top);
    return options;
  }

 private:
  void Add(std::string message) { problems_.push_back({{job_.file}, std::move(message)}); }

  EdgeModel Edge() {
    EdgeModel edge;
    edge.material = MaterialOf(from_);
    edge.cutter = MakeCutterShape(inputs_.cell.tool);
    edge.teeth = from_.teeth;
    edge.radial_ratio = from_.radial_ratio;
    edge.axial_ratio = from_.axial_ratio;
    return edge;
  }

  /// A drill's hole says how deep and wide it cuts, unless what stands does.
  EngagementOptions ReadDrill(double point, EngagementOptions options) {
    CheckStock();
    if (!problems_.empty()) throw InputError(std::move(problems_));
    options.drill =
        DrillLips{options.edge.material, inputs_.cell.tool.cutter_diameter, options.edge.teeth, point};
    if (job_.stock == Standing::kMesh) options.stock = StockMesh();
    return options;
  }

  /// The depth of a layer; returns how high the stock stands above the part.
  double ReadDepth(EngagementOptions& options) {
    const Layers& depth = job_.toolpath.layers;
    double above = depth.allowance + depth.total;
    if (depth.total > 0) {
      const auto offsets = LayerOffsets(depth);
      double least = above - offsets.front(), most = least;
      for (size_t i = 1; i < offsets.size(); ++i) {
        least = std::min(least, offsets[i - 1] - offsets[i]);
        most = std::max(most, offsets[i - 1] - offsets[i]);
      }
      options.depth = least;
      if (from_.depth && std::abs(*from_.depth - most) > kSameShare * most)
        Add(
            fmt::format("process.cutting.depth_mm: given {:.6g}, but the layers of toolpath.depth are {:.6g} "
                        "mm deep; leave it out",
                        *from_.depth, most));
    } else if (from_.depth) {
      options.depth = *from_.depth;
      above += *from_.depth;
    } else {
      Add("process.cutting.depth_mm: missing; required where toolpath.depth gives no layers");
    }
    return above;
  }

  void ReadWidth(EngagementOptions& options) {
    const double diameter = inputs_.cell.tool.cutter_diameter, step = job_.toolpath.stepover;
    const bool by_step = step > 0 && job_.toolpath.scallop <= 0;
    const double from_step = std::min(step, diameter);
    if (from_.width && *from_.width > diameter)
      Add(fmt::format(
          "process.cutting.width_mm: given {:.6g}; allowed: at most the cutter's diameter, {:.6g} "
          "mm",
          *from_.width, diameter));
    if (from_.width && by_step && from_.side != MillingSide::kSlot &&
        std::abs(*from_.width - from_step) > kSameShare * diameter)
      Add(
          fmt::format("process.cutting.width_mm: given {:.6g}, but passes are {:.6g} mm apart "
                      "(toolpath.stepover_mm); leave it out, or give {:.6g}",
                      *from_.width, step, from_step));
    if (!from_.side) {
      if (from_.width && !by_step)
        Add("process.cutting.width_mm: is taken from path and stock where no side is given; leave it out, or "
            "give process.cutting.side");
      return;
    }
    const MillingSide side = *from_.side;
    if (side != MillingSide::kSlot && !from_.width && !by_step)
      Add(
          fmt::format("process.cutting.width_mm: missing; required with side {} where the tool path has no "
                      "step-over",
                      WordOf(kMillingSideWords, side)));
    options.stated = {side, from_.width.value_or(from_step)};
  }

  void CheckStock() {
    if (job_.stock == Standing::kMesh) {
      if (!job_.workpiece.HasStock()) Add("process.stock: given mesh; the job needs workpiece.stock");
    } else if (job_.toolpath.strategy->DrillPoint()) {
      return;  // it goes into the full
    } else if (job_.toolpath.strategy->NeedsStock()) {
      Add(fmt::format(
          "process.stock: given region; strategy {} cuts what stands of workpiece.stock; allowed: "
          "mesh",
          job_.toolpath.strategy->Name()));
    } else if ((!job_.toolpath.strategy->File().empty() && !job_.toolpath.strategy->NeedsPart()) ||
               mesh_.face_count() == 0) {
      Add("process.cutting: what material a CAM path finds is not known; give workpiece.stock "
          "(process.stock: "
          "mesh), or process.cutting.side and width_mm");
    }
  }

  InMaterial StockMesh() const {
    const Mesh stock(RawStock(inputs_));
    if (inputs_.cut_before.empty())
      return [stock](const Eigen::Vector3d& place) { return stock.Contains(place); };
    const auto taken = std::make_shared<TakenOff>(inputs_.cut_before, kBeforeTolerance);
    return [stock, taken](const Eigen::Vector3d& place) {
      return !taken->Holds(place) && stock.Contains(place);
    };
  }

  InMaterial Raised(double top) const {
    const ToolpathOptions options = MakeToolpathOptions(job_, inputs_.cell.tool);
    const auto raised =
        std::make_shared<RaisedRegion>(UnbentPart(job_, mesh_), options.region, top, options.cutter.radius);
    const PartBending* bending = BendingOf(job_);
    if (!bending) return [raised](const Eigen::Vector3d& place) { return raised->Holds(place); };
    return
        [raised, bent = *bending](const Eigen::Vector3d& place) { return raised->Holds(bent.Unbent(place)); };
  }

  const JobInputs& inputs_;
  const JobSettings& job_;
  const CuttingSettings& from_;
  const Mesh& mesh_;
  std::vector<Problem> problems_;
};

}  // namespace

double ChipExponent(const JobSettings& job) { return MaterialOf(*job.cutting).mc; }

EngagementOptions MakeEngagementOptions(const JobInputs& inputs, const Mesh& mesh) {
  return CuttingReader(inputs, mesh).Read();
}

}  // namespace millpose
