// SPDX-License-Identifier: GPL-3.0-or-later
// PlanResult and PassResult as CBOR. Each type lists its fields once (Fields); writer and reader both walk
// that list.
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "plan/plan_result.hpp"

namespace millpose {
namespace {

using Json = nlohmann::json;

// The type of a field that is neither number, text, matrix nor list must have a Fields() of its own.
template <class T>
concept Scalar = std::is_arithmetic_v<T> || std::is_same_v<T, std::string>;

struct Writer {
  Json json = Json::object();

  template <class T>
  void operator()(const char* key, const T& value) {
    json[key] = Write(value);
  }
  /// A value that is written where there is one.
  template <class T>
  void operator()(const char* key, const std::optional<T>& value) {
    if (value) json[key] = Write(*value);
  }
  /// An enum by its word.
  template <class E, size_t kCount>
  void Words(const char* key, const E& value, const EnumWords<E, kCount>& words) {
    json[key] = WordOf(words, value);
  }

  template <Scalar T>
  static Json Write(const T& value) {
    return value;
  }
  template <class T>
  requires std::is_enum_v<T>
  static Json Write(const T& value) { return static_cast<int>(value); }
  template <int kRows, int kCols>
  static Json Write(const Eigen::Matrix<double, kRows, kCols>& value) {
    return std::vector<double>(value.data(), value.data() + value.size());
  }
  static Json Write(const Pose& value) { return Write(Eigen::Matrix4d(value.matrix())); }
  static Json Write(const std::array<double, 6>& value) { return value; }
  template <class T>
  static Json Write(const std::vector<T>& values) {
    Json list = Json::array();
    for (const T& value : values) list.push_back(Write(value));
    return list;
  }
  template <class T>
  requires(std::is_class_v<T> && !Scalar<T>) static Json Write(const T& value) {
    Writer inner;
    Fields(inner, const_cast<T&>(value));  // Fields is shared with the reader; the writer only reads
    return std::move(inner.json);
  }
};

struct Reader {
  const Json& json;

  template <class T>
  void operator()(const char* key, T& value) {
    Read(json.at(key), value);
  }
  template <class T>
  void operator()(const char* key, std::optional<T>& value) {
    value.reset();
    if (const auto found = json.find(key); found != json.end()) Read(*found, value.emplace());
  }
  template <class E, size_t kCount>
  void Words(const char* key, E& value, const EnumWords<E, kCount>& words) {
    const std::string given = json.at(key);
    const auto found = std::ranges::find(words, given, [](const auto& word) { return word.first; });
    if (found == words.end()) throw std::runtime_error(fmt::format("{} '{}' is not known", key, given));
    value = found->second;
  }

  template <Scalar T>
  static void Read(const Json& from, T& value) {
    from.get_to(value);
  }
  template <class T>
  requires std::is_enum_v<T>
  static void Read(const Json& from, T& value) { value = static_cast<T>(from.get<int>()); }
  template <int kRows, int kCols>
  static void Read(const Json& from, Eigen::Matrix<double, kRows, kCols>& value) {
    if (from.size() != static_cast<size_t>(value.size()))
      throw std::runtime_error("wrong number of matrix entries");
    for (Eigen::Index i = 0; i < value.size(); ++i)
      value.data()[i] = from.at(static_cast<size_t>(i)).get<double>();
  }
  static void Read(const Json& from, Pose& value) {
    Eigen::Matrix4d matrix;
    Read(from, matrix);
    value.matrix() = matrix;
  }
  static void Read(const Json& from, std::array<double, 6>& value) { from.get_to(value); }
  template <class T>
  static void Read(const Json& from, std::vector<T>& values) {
    values.resize(from.size());
    for (size_t i = 0; i < values.size(); ++i) Read(from.at(i), values[i]);
  }
  template <class T>
  requires(std::is_class_v<T> && !Scalar<T>) static void Read(const Json& from, T& value) {
    Reader inner{from};
    Fields(inner, value);
  }
};

template <class Archive>
void Fields(Archive& a, Engagement& e) {
  a("force", e.force);
  a("width", e.width);
  a("depth", e.depth);
  a("side", e.side);
}

template <class Archive>
void Fields(Archive& a, MillingPoint& p) {
  a("position", p.position);
  a("normal", p.normal);
  a("feed", p.feed);
  a("tool_axis", p.tool_axis);
  a("feed_rate", p.feed_rate);
  a("arc_length", p.arc_length);
  a("kind", p.kind);
  a("region", p.region);
  a("source_line", p.source_line);
  a("gouge", p.gouge);
  a("engagement", p.engagement);
}

template <class Archive>
void Fields(Archive& a, MillingPlaneIndices& i) {
  a("lambda_t1", i.lambda_t1);
  a("lambda_t2", i.lambda_t2);
  a("lambda_n", i.lambda_n);
  a("mu", i.mu);
  a("normal_compliance", i.normal_compliance);
}

template <class Archive>
void Fields(Archive& a, PaperAnswer& p) {
  a("within_tolerance", p.within_tolerance);
  a("position_error", p.position_error);
  a("angle_error", p.angle_error);
  a("objective", p.objective);
}

template <class Archive>
void Fields(Archive& a, Compensation::Along& d) {
  a("low", d.low);
  a("expected", d.expected);
  a("high", d.high);
  a("taken", d.taken);
}

template <class Archive>
void Fields(Archive& a, Compensation& c) {
  a("q", c.q);
  a("shift", c.shift);
  a("weight", c.weight);
  a("force", c.force);
  a("normal", c.normal);
  a("across", c.across);
  a("bounded", c.bounded);
}

template <class Archive>
void Fields(Archive& a, PlannedPoint& p) {
  a("point", p.point);
  a("skip", p.skip);
  a("detail", p.detail);
  a("piece", p.piece);
  a("freedoms", p.freedoms);
  a("branch", p.branch);
  a("q", p.q);
  a("indices", p.indices);
  a("lambda_3", p.lambda_3);
  a("lambda_3_direction", p.lambda_3_direction);
  a("dexterity", p.dexterity);
  a("objective", p.objective);
  a("unsmoothed", p.unsmoothed);
  a("free_optimum", p.free_optimum);
  a("genetic_optimum", p.genetic_optimum);
  a("own_optimum", p.own_optimum);
  a("exhaustive_optimum", p.exhaustive_optimum);
  a("own_rotation", p.own_rotation);
  a("free_rotation", p.free_rotation);
  a("own_branch", p.own_branch);
  a("free_branch", p.free_branch);
  a("barred", p.barred);
  a("verdicts", p.verdicts);
  a("genetic_evaluations", p.genetic_evaluations);
  a("paper", p.paper);
  a("from_genetic", p.from_genetic);
  a("clearance", p.clearance);
  a("compensation", p.compensation);
}

template <class Archive>
void Fields(Archive& a, Piece& p) {
  a("pass", p.pass);
  a("piece", p.piece);
  a("first", p.first);
  a("last", p.last);
  a("closed", p.closed);
}

template <class Archive>
void Fields(Archive& a, Smoothing& s) {
  a("square_before", s.square_before);
  a("square_after", s.square_after);
  a("objective_before", s.objective_before);
  a("objective_after", s.objective_after);
}

template <class Archive>
void Fields(Archive& a, LadderBound& b) {
  a("cost", b.cost);
  a("cost_bound", b.cost_bound);
  a("worst", b.worst);
  a("worst_bound", b.worst_bound);
}

template <class Archive>
void Fields(Archive& a, PassResult& p) {
  a("pass", p.pass);
  a("rotation_reference", p.rotation_reference);
  a("external", p.external);
  a("points", p.points);
  a("pieces", p.pieces);
  a("grid_gap", p.grid_gap);
  a("poses_checked", p.poses_checked);
  a("nodes_pruned", p.nodes_pruned);
  a("nodes", p.nodes);
  a("nodes_checked", p.nodes_checked);
  a("pairs_checked", p.pairs_checked);
  a("pairs_saved", p.pairs_saved);
  a("smoothing", p.smoothing);
  a("bound", p.bound);
  a("pairs", p.pairs);
  a("uncut", p.uncut);
  a("lifts", p.lifts);
  a("lift_gain", p.lift_gain);
  a("stripe", p.stripe);
  a("opened_at", p.opened_at);
}

template <class Archive>
void Fields(Archive& a, ExternalMove& m) {
  a("from", m.from);
  a("to", m.to);
  a("at", m.at);
  a("duration", m.duration);
}

template <class Archive>
void Fields(Archive& a, Gap& g) {
  a("from_pass", g.from_pass);
  a("from_piece", g.from_piece);
  a("to_pass", g.to_pass);
  a("to_piece", g.to_piece);
  a("planned", g.planned);
  a("detail", g.detail);
  a("X_WT_retracted", g.X_WT_retracted);
  a("X_WT_approach", g.X_WT_approach);
  a("joints", g.joints);
  a("clearance", g.clearance);
  a("clearance_share", g.clearance_share);
  a("duration", g.duration);
  a("external", g.external);
  a("poses_checked", g.poses_checked);
}

template <class Archive>
void Fields(Archive& a, Arm& arm) {
  a("name", arm.name);
  a("family", arm.family);
  a("d1", arm.d1);
  a("a1", arm.a1);
  a("dy", arm.dy);
  a("a2", arm.a2);
  a("d4", arm.d4);
  a("dz", arm.dz);
  a("d5", arm.d5);
  a("d6", arm.d6);
  a("sign", arm.sign);
  a("offset", arm.offset);
  a("lower", arm.lower);
  a("upper", arm.upper);
  a("speed", arm.speed);
  a("acceleration", arm.acceleration);
  a("acceleration_assumed", arm.acceleration_assumed);
  a("stiffness", arm.stiffness);
}

template <class Archive>
void Fields(Archive& a, ExternalAxis& axis) {
  a("name", axis.name);
  a.Words("kind", axis.kind, kAxisKindWords);
  a.Words("carries", axis.carries, kCarriesWords);
  a("direction", axis.direction);
  a("origin", axis.origin);
  a("lower", axis.lower);
  a("upper", axis.upper);
  a("home", axis.home);
  a("speed", axis.speed);
  a("acceleration", axis.acceleration);
  a("compliance", axis.compliance);
}

template <class Archive>
void Fields(Archive& a, PlanResult& r) {
  a("job", r.job);
  a("cell", r.cell);
  a("input_hash", r.input_hash);
  a("seed", r.seed);
  a("arm", r.arm);
  a("external_axes", r.external_axes);
  a("X_WB", r.X_WB);
  a("X_FT", r.X_FT);
  a("X_WP", r.X_WP);
  a("home", r.home);
  a("spindle_speed", r.spindle_speed);
  a("passes", r.passes);
  a("gaps", r.gaps);
  a("objective_name", r.objective_name);
  a("objective_unit", r.objective_unit);
  a.Words("stiffness_origin", r.stiffness_origin, kStiffnessOriginWords);
}

// The leading field tells a file of ours from others and one version from the next.
constexpr const char* kFormat = "millpose 5";

template <class T>
std::string ToBytes(const T& value) {
  Json json = Writer::Write(value);
  json["format"] = kFormat;
  std::string bytes;
  Json::to_cbor(json, bytes);
  return bytes;
}

template <class T>
T FromBytes(std::string_view bytes, const std::string& name) {
  try {
    const Json json = Json::from_cbor(bytes.begin(), bytes.end());
    if (json.at("format") != kFormat) throw std::runtime_error("written by another version");
    T value;
    Reader::Read(json, value);
    return value;
  } catch (const std::exception& error) {
    throw InputError({name}, fmt::format("not a plan that this version wrote: {}", error.what()));
  }
}

}  // namespace

std::string Serialise(const PlanResult& result) { return ToBytes(result); }
std::string Serialise(const PassResult& result) { return ToBytes(result); }
std::string Serialise(const Gap& result) { return ToBytes(result); }

PlanResult ParsePlanResult(std::string_view bytes, const std::string& name) {
  return FromBytes<PlanResult>(bytes, name);
}

PassResult ParsePassResult(std::string_view bytes, const std::string& name) {
  return FromBytes<PassResult>(bytes, name);
}

Gap ParseGap(std::string_view bytes, const std::string& name) { return FromBytes<Gap>(bytes, name); }

}  // namespace millpose
