// SPDX-License-Identifier: GPL-3.0-or-later
// PlanResult and PassResult as CBOR. Each type lists its fields once (Fields); writer and reader both walk
// that list, so fields stand in its order.
#include "base/error.hpp"
#include "planning/result/cbor.hpp"
#include "planning/result/write_plan.hpp"

namespace millpose {
namespace {

// The type of a field that is neither number, text, matrix nor list must have a Fields() of its own.
template <class T>
concept Scalar = std::is_arithmetic_v<T> || std::is_same_v<T, std::string>;

/// How many fields are written of a value.
struct Counter {
  size_t fields = 0;

  template <class T>
  void operator()(const char*, const T&) {
    ++fields;
  }
  template <class T>
  void operator()(const char*, const std::optional<T>& value) {
    fields += value.has_value();
  }
  template <class E, size_t kCount>
  void Words(const char*, const E&, const EnumWords<E, kCount>&) {
    ++fields;
  }
};

struct Writer {
  std::string& out;
  const ByteSink* sink = nullptr;  ///< takes what `out` holds before and after every pass, where there is one
  int threads = 1;                 ///< that passes are written on for it
  CborWriter to{out};

  template <class T>
  void operator()(const char* key, const T& value) {
    to.Text(key);
    Write(value);
  }
  /// A value that is written where there is one.
  template <class T>
  void operator()(const char* key, const std::optional<T>& value) {
    if (value) (*this)(key, *value);
  }
  /// An enum by its word.
  template <class E, size_t kCount>
  void Words(const char* key, const E& value, const EnumWords<E, kCount>& words) {
    (*this)(key, std::string(WordOf(words, value)));
  }

  void Write(bool value) { to.Bool(value); }
  void Write(double value) { to.Number(value); }
  void Write(uint64_t value) { to.Unsigned(value); }
  void Write(const std::string& value) { to.Text(value); }
  template <class T>
  requires(std::is_enum_v<T> || std::is_integral_v<T>) void Write(const T& value) {
    to.Integer(static_cast<int64_t>(value));
  }
  template <int kRows, int kCols>
  void Write(const Eigen::Matrix<double, kRows, kCols>& value) {
    to.List(static_cast<size_t>(value.size()));
    for (Eigen::Index i = 0; i < value.size(); ++i) to.Number(value.data()[i]);
  }
  void Write(const Pose& value) { Write(Eigen::Matrix4d(value.matrix())); }
  template <size_t kSize>
  void Write(const std::array<double, kSize>& value) {
    to.List(kSize);
    for (const double number : value) to.Number(number);
  }
  template <class T>
  void Write(const std::vector<T>& values) {
    to.List(values.size());
    for (const T& value : values) Write(value);
  }
  void Write(const std::vector<PassResult>& passes) {
    to.List(passes.size());
    Flush();
    const auto pass = [&](size_t i) {
      std::string bytes;
      Writer{bytes}.Write(passes[i]);
      return bytes;
    };
    WriteInOrder(passes.size(), threads, {}, pass, *sink);
  }
  void Flush() {
    (*sink)(out);
    out.clear();
  }
  template <class T>
  requires(std::is_class_v<T> && !Scalar<T>) void Write(const T& value) {
    auto& fields = const_cast<T&>(value);  // Fields is shared with the reader; the writer only reads
    Counter counter;
    Fields(counter, fields);
    to.Map(counter.fields);
    Fields(*this, fields);
  }
};

/// Reads the fields of a value in the order in which they are written.
struct Reader {
  CborReader& from;
  size_t left = 0;  ///< entries of the map that is read

  template <class T>
  void operator()(const char* key, T& value) {
    if (!Take(key)) throw std::runtime_error(fmt::format("{} expected", key));
    Read(value);
  }
  template <class T>
  void operator()(const char* key, std::optional<T>& value) {
    value.reset();
    if (Take(key)) Read(value.emplace());
  }
  template <class E, size_t kCount>
  void Words(const char* key, E& value, const EnumWords<E, kCount>& words) {
    std::string given;
    (*this)(key, given);
    const auto found = std::ranges::find(words, given, [](const auto& word) { return word.first; });
    if (found == words.end()) throw std::runtime_error(fmt::format("{} '{}' is not known", key, given));
    value = found->second;
  }

  void Read(bool& value) { value = from.Bool(); }
  void Read(double& value) { value = from.Number(); }
  void Read(uint64_t& value) { value = from.Unsigned(); }
  void Read(std::string& value) { value = from.Text(); }
  template <class T>
  requires(std::is_enum_v<T> || std::is_integral_v<T>) void Read(T& value) {
    const int64_t given = from.Integer();
    value = static_cast<T>(given);
    if (static_cast<int64_t>(value) != given) throw std::runtime_error("a number out of range");
  }
  template <int kRows, int kCols>
  void Read(Eigen::Matrix<double, kRows, kCols>& value) {
    Numbers(value.data(), static_cast<size_t>(value.size()));
  }
  void Read(Pose& value) {
    Eigen::Matrix4d matrix;
    Read(matrix);
    value.matrix() = matrix;
  }
  template <size_t kSize>
  void Read(std::array<double, kSize>& value) {
    Numbers(value.data(), kSize);
  }
  template <class T>
  void Read(std::vector<T>& values) {
    const size_t count = from.List();
    values.clear();
    values.reserve(std::min<size_t>(count, 1024));                   // whatever damaged bytes say
    for (size_t i = 0; i < count; ++i) Read(values.emplace_back());  // never more than the bytes hold
  }
  template <class T>
  requires(std::is_class_v<T> && !Scalar<T>) void Read(T& value) {
    Reader inner{from, from.Map()};
    Fields(inner, value);
    inner.End();
  }
  void End() const {
    if (left > 0) throw std::runtime_error(fmt::format("'{}' is not known", from.Text()));
  }

 private:
  bool Take(const char* key) {
    if (left == 0 || !from.IsNext(key)) return false;
    from.Text();
    --left;
    return true;
  }
  void Numbers(double* to, size_t count) {
    if (from.List() != count) throw std::runtime_error("wrong number of matrix entries");
    for (size_t i = 0; i < count; ++i) to[i] = from.Number();
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
  a("map", c.map);
  a("bounded", c.bounded);
  a("arm_shift", c.arm_shift);
  a("arm_turn", c.arm_turn);
  a("gear_shift", c.gear_shift);
  a("arm_left", c.arm_left);
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
  a("external", p.external);
}

template <class Archive>
void Fields(Archive& a, Segment& p) {
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
void Fields(Archive& a, LinkMove& g) {
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
void Fields(Archive& a, CoupledLimit& limit) {
  a("factors", limit.factors);
  a("at_most", limit.at_most);
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
  a("coupled_limits", arm.coupled_limits);
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
constexpr const char* kFormat = "millpose 8";

/// The fields of a value behind the leading one.
template <class T>
void WriteTop(const T& value, Writer& writer) {
  auto& fields = const_cast<T&>(value);
  Counter counter;
  Fields(counter, fields);
  writer.to.Map(1 + counter.fields);
  writer("format", std::string(kFormat));
  Fields(writer, fields);
}

template <class T>
std::string ToBytes(const T& value) {
  std::string bytes;
  Writer writer{bytes};
  WriteTop(value, writer);
  return bytes;
}

template <class T>
T FromBytes(std::string_view bytes, const std::string& name) {
  try {
    CborReader from(bytes);
    Reader reader{from, from.Map()};
    std::string format;
    reader("format", format);
    if (format != kFormat) throw std::runtime_error("written by another version");
    T value;
    Fields(reader, value);
    reader.End();
    if (!from.AtEnd()) throw std::runtime_error("something follows its end");
    return value;
  } catch (const std::exception& error) {
    throw InputError({name}, fmt::format("not a plan that this version wrote: {}", error.what()));
  }
}

}  // namespace

void WritePlan(const PlanResult& result, int threads, const ByteSink& sink) {
  std::string bytes;
  Writer writer{bytes, &sink, threads};
  WriteTop(result, writer);
  writer.Flush();
}

std::string Serialise(const PlanResult& result) {
  return BytesOf([&](const ByteSink& sink) { WritePlan(result, 1, sink); });
}

std::string Serialise(const PassResult& result) { return ToBytes(result); }
std::string Serialise(const LinkMove& result) { return ToBytes(result); }

PlanResult ParsePlanResult(std::string_view bytes, const std::string& name) {
  return FromBytes<PlanResult>(bytes, name);
}

PassResult ParsePassResult(std::string_view bytes, const std::string& name) {
  return FromBytes<PassResult>(bytes, name);
}

LinkMove ParseLinkMove(std::string_view bytes, const std::string& name) {
  return FromBytes<LinkMove>(bytes, name);
}

}  // namespace millpose
