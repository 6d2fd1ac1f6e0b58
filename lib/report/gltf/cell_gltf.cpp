// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/gltf/cell_gltf.hpp"

#include <tiny_gltf.h>

#include <bit>
#include <limits>
#include <sstream>

#include "base/trig.hpp"
#include "planning/result/station.hpp"
#include "report/html.hpp"
#include "report/ros/cell_tree.hpp"
#include "report/view_mesh.hpp"

static_assert(std::endian::native == std::endian::little, "glTF's numbers are little-endian");

namespace millpose {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Diffuse colours, red, green, blue and opacity.
std::vector<double> ColourOf(BodyClass body_class) {
  switch (body_class) {
    case BodyClass::kWorkpiece:
      return {0.58, 0.63, 0.67, 1};
    case BodyClass::kLink:
      return {0.85, 0.35, 0.08, 1};
    case BodyClass::kSpindle:
    case BodyClass::kHolder:
      return {0.10, 0.17, 0.28, 1};
    case BodyClass::kCutter:
      return {0.45, 0.04, 0.03, 1};
    case BodyClass::kStock:
      return {0.55, 0.48, 0.35, 0.25};
    case BodyClass::kFixture:
    case BodyClass::kPlatform:
      break;
  }
  return {0.30, 0.34, 0.38, 1};
}

class GltfWriter {
 public:
  GltfWriter(const Cell& cell, const RosNames& names, const PlanResult& plan, const Timeline& timeline)
      : cell_(cell), names_(names), plan_(plan), timeline_(timeline), tree_(cell, names) {}

  std::string Write() {
    model_.asset.version = "2.0";
    model_.asset.generator = "millpose";
    model_.buffers.emplace_back();
    AddFrames();
    for (size_t i = 0; i < cell_.bodies.size(); ++i) AddBody(cell_.bodies[i], names_.bodies[i]);
    AddPath();
    AddRun();
    tinygltf::Scene scene;
    scene.name = names_.cell;
    scene.nodes = {root_};
    model_.scenes = {scene};
    model_.defaultScene = 0;
    std::ostringstream stream;
    tinygltf::TinyGLTF().WriteGltfSceneToStream(&model_, stream, false, true);
    return stream.str();
  }

 private:
  static std::vector<double> Numbers(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
  static std::vector<double> Numbers(const Quaterniond& q) { return {q.x(), q.y(), q.z(), q.w()}; }

  int AddNode(const std::string& name, const Pose& X) {
    tinygltf::Node node;
    node.name = name;
    node.translation = Numbers(X.translation().eval());
    node.rotation = Numbers(Quaterniond(X.linear()).normalized());
    model_.nodes.push_back(std::move(node));
    return static_cast<int>(model_.nodes.size()) - 1;
  }
  tinygltf::Node& NodeAt(int number) { return model_.nodes[static_cast<size_t>(number)]; }

  /// W stands in mm with z up below a node that makes metres and y up of it.
  void AddFrames() {
    Pose up = Pose::Identity();
    up.linear() << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    root_ = AddNode("millpose", up);
    NodeAt(root_).scale = {1 / kMetre, 1 / kMetre, 1 / kMetre};
    for (const CellFrame& frame : tree_.frames()) {
      const int node = AddNode(frame.name, frame.X);
      nodes_.push_back(node);
      NodeAt(frame.parent < 0 ? root_ : nodes_[static_cast<size_t>(frame.parent)]).children.push_back(node);
    }
  }

  /// Numbers at the buffer's end, four bytes each; returns the accessor.
  template <class T>
  int AddAccessor(const std::vector<T>& values, int type, int target) {
    static_assert(sizeof(T) == 4);
    std::vector<unsigned char>& bytes = model_.buffers.front().data;
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes.size();
    view.byteLength = 4 * values.size();
    view.target = target;
    bytes.resize(bytes.size() + 4 * values.size());
    std::memcpy(bytes.data() + view.byteOffset, values.data(), 4 * values.size());
    model_.bufferViews.push_back(view);
    const auto width = static_cast<size_t>(tinygltf::GetNumComponentsInType(static_cast<uint32_t>(type)));
    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model_.bufferViews.size()) - 1;
    accessor.componentType =
        std::is_same_v<T, float> ? TINYGLTF_COMPONENT_TYPE_FLOAT : TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    accessor.type = type;
    accessor.count = values.size() / width;
    model_.accessors.push_back(std::move(accessor));
    return static_cast<int>(model_.accessors.size()) - 1;
  }
  /// With the bounds that glTF asks for of places and times.
  int AddBounded(const std::vector<float>& values, int type, int target) {
    const int number = AddAccessor(values, type, target);
    tinygltf::Accessor& accessor = model_.accessors.back();
    const size_t width = values.size() / accessor.count;
    accessor.minValues.assign(width, std::numeric_limits<double>::infinity());
    accessor.maxValues.assign(width, -std::numeric_limits<double>::infinity());
    for (size_t i = 0; i < values.size(); ++i) {
      accessor.minValues[i % width] = std::min<double>(accessor.minValues[i % width], values[i]);
      accessor.maxValues[i % width] = std::max<double>(accessor.maxValues[i % width], values[i]);
    }
    return number;
  }

  int AddPlaces(const std::vector<Vector3d>& places) {
    std::vector<float> values;
    for (const Vector3d& place : places)
      for (const double x : place) values.push_back(static_cast<float>(x));
    return AddBounded(values, TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER);
  }

  int MaterialOf(const std::string& name, const std::vector<double>& colour) {
    for (size_t i = 0; i < model_.materials.size(); ++i)
      if (model_.materials[i].name == name) return static_cast<int>(i);
    tinygltf::Material material;
    material.name = name;
    material.pbrMetallicRoughness.baseColorFactor = colour;
    material.pbrMetallicRoughness.metallicFactor = 0.1;
    material.pbrMetallicRoughness.roughnessFactor = 0.7;
    material.doubleSided = true;  // parts of a cell may be open surfaces
    if (colour.back() < 1) material.alphaMode = "BLEND";
    model_.materials.push_back(std::move(material));
    return static_cast<int>(model_.materials.size()) - 1;
  }

  void AddBody(const Body& body, const std::string& name) {
    const HtmlLimits limits;
    const size_t most =
        body.body_class == BodyClass::kWorkpiece ? limits.workpiece_triangles : limits.body_triangles;
    const Triangles shape = ThinnedMesh(ViewMesh(body.shape), most);
    const auto [frame, X] = tree_.MountOf(body);
    const int node = AddNode(name, X);
    NodeAt(nodes_[frame]).children.push_back(node);
    if (shape.faces.empty()) return;
    std::vector<uint32_t> corners;
    for (const auto& face : shape.faces)
      for (const int corner : face) corners.push_back(static_cast<uint32_t>(corner));
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.attributes["POSITION"] = AddPlaces(shape.vertices);
    primitive.indices = AddAccessor(corners, TINYGLTF_TYPE_SCALAR, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    primitive.material = MaterialOf(WordOf(kBodyClassWords, body.body_class), ColourOf(body.body_class));
    AddMesh(name, {primitive}, node);
  }

  void AddMesh(const std::string& name, std::vector<tinygltf::Primitive> primitives, int node) {
    tinygltf::Mesh mesh;
    mesh.name = name;
    mesh.primitives = std::move(primitives);
    model_.meshes.push_back(std::move(mesh));
    NodeAt(node).mesh = static_cast<int>(model_.meshes.size()) - 1;
  }

  /// A line for each piece, on the part.
  void AddPath() {
    std::vector<tinygltf::Primitive> lines;
    for (const PassResult& pass : plan_.passes)
      for (const Segment& piece : pass.pieces) {
        std::vector<Vector3d> tips;
        for (auto t = static_cast<size_t>(piece.first); t <= static_cast<size_t>(piece.last); ++t)
          if (pass.points[t].skip == Infeasibility::kNone)
            tips.emplace_back(ToolAt(plan_, pass, t).translation());
        if (piece.closed && !tips.empty()) tips.push_back(tips.front());
        if (tips.size() < 2) continue;
        tinygltf::Primitive line;
        line.mode = TINYGLTF_MODE_LINE_STRIP;
        line.attributes["POSITION"] = AddPlaces(tips);
        line.material = MaterialOf("path", {0.02, 0.25, 0.75, 1});
        lines.push_back(std::move(line));
      }
    if (lines.empty()) return;
    const int node = AddNode("path", Pose::Identity());
    NodeAt(nodes_[tree_.part()]).children.push_back(node);
    AddMesh("path", std::move(lines), node);
  }

  static double ValueAt(const RunInstant& instant, size_t axis) {
    return axis < 6 ? instant.q[static_cast<Eigen::Index>(axis)] : instant.external[axis - 6];
  }

  /// Times must rise strictly, also where the arm leaps.
  std::vector<float> Times() const {
    std::vector<float> times;
    for (const RunInstant& instant : timeline_) {
      const auto time = static_cast<float>(instant.time);
      times.push_back(times.empty() ? time
                                    : std::max(time, std::nextafter(times.back(),
                                                                    std::numeric_limits<float>::infinity())));
    }
    return times;
  }

  void AddRun() {
    tinygltf::Animation run;
    run.name = "run";
    const int times = AddBounded(Times(), TINYGLTF_TYPE_SCALAR, 0);
    for (size_t f = 0; f < tree_.frames().size(); ++f) {
      const CellFrame& frame = tree_.frames()[f];
      if (frame.joint == CellFrame::Joint::kFixed) continue;
      const bool turns = frame.joint == CellFrame::Joint::kTurns;
      tinygltf::AnimationSampler sampler;
      sampler.input = times;
      sampler.output = turns ? AddAccessor(Turns(frame), TINYGLTF_TYPE_VEC4, 0)
                             : AddAccessor(Slides(frame), TINYGLTF_TYPE_VEC3, 0);
      tinygltf::AnimationChannel channel;
      channel.sampler = static_cast<int>(run.samplers.size());
      channel.target_node = nodes_[f];
      channel.target_path = turns ? "rotation" : "translation";
      run.samplers.push_back(std::move(sampler));
      run.channels.push_back(std::move(channel));
    }
    model_.animations = {std::move(run)};
  }

  /// Of each instant as a quaternion; neighbours on the same half of the sphere, so that readers that do not
  /// look for the shorter way find it.
  std::vector<float> Turns(const CellFrame& frame) const {
    const Quaterniond still = Quaterniond(frame.X.linear()).normalized();
    std::vector<float> values;
    Quaterniond before = still;
    for (const RunInstant& instant : timeline_) {
      const auto [sine, cosine] = SinCos(ValueAt(instant, frame.axis_number) / 2);
      Quaterniond now =
          still * Quaterniond(cosine, sine * frame.axis.x(), sine * frame.axis.y(), sine * frame.axis.z());
      if (now.dot(before) < 0) now.coeffs() *= -1;
      for (const double x : Numbers(now)) values.push_back(static_cast<float>(x));
      before = now;
    }
    return values;
  }

  std::vector<float> Slides(const CellFrame& frame) const {
    std::vector<float> values;
    for (const RunInstant& instant : timeline_) {
      const Vector3d at = frame.X * (ValueAt(instant, frame.axis_number) * frame.axis).eval();
      for (const double x : at) values.push_back(static_cast<float>(x));
    }
    return values;
  }

  const Cell& cell_;
  const RosNames& names_;
  const PlanResult& plan_;
  const Timeline& timeline_;
  CellTree tree_;
  tinygltf::Model model_;
  int root_ = 0;
  std::vector<int> nodes_;  ///< of the tree's frames
};

}  // namespace

std::string CellGltf(const Cell& cell, const RosNames& names, const PlanResult& plan,
                     const Timeline& timeline) {
  return GltfWriter(cell, names, plan, timeline).Write();
}

}  // namespace millpose
