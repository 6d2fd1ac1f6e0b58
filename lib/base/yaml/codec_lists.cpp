// SPDX-License-Identifier: GPL-3.0-or-later
// Codecs of lists with a fixed number of items.
#include "base/yaml/codec.hpp"

namespace millpose::yaml {
namespace {

// A fixed number of items read into what `place(i)` gives.
template <class T, class PlaceOf>
void ReadItems(const Value& value, const Context& context, size_t count, const std::string& type,
               const Codec<T>& item, PlaceOf place) {
  if (value.kind != Value::Kind::kList || value.items.size() != count) return context.AddWrong(value, type);
  for (size_t i = 0; i < count; ++i) item.read(value.items[i], context.Child(i), place(i));
}

template <int N>
Codec<Eigen::Matrix<double, N, 1>> NumberList(const Unit& unit, const Range& range) {
  using Numbers = Eigen::Matrix<double, N, 1>;
  const Codec<double> item = Real(unit, range);
  Codec<Numbers> codec;
  codec.type = fmt::format("list of {} numbers{}", N, item.type.substr(std::string_view("number").size()));
  codec.schema = [item] { return codec_detail::ListSchema(item.schema(), N, N); };
  codec.read = [item, type = codec.type](const Value& value, const Context& context, Numbers& result) {
    ReadItems(value, context, N, type, item, [&](size_t i) -> double& { return result[i]; });
  };
  codec.write = [item](const Numbers& numbers) {
    Value list = Value::List();
    for (int i = 0; i < N; ++i) list.items.push_back(item.write(numbers[i]));
    return list;
  };
  return codec;
}

}  // namespace

Codec<Eigen::Vector3d> Numbers3(const Unit& unit, const Range& range) { return NumberList<3>(unit, range); }
Codec<Eigen::Vector3d> Coordinates() { return Numbers3(kMm, Between(-1e6, 1e6)); }
Codec<Six> Numbers6(const Unit& unit, const Range& range) { return NumberList<6>(unit, range); }

Codec<Eigen::Vector3d> Direction() {
  Codec<Eigen::Vector3d> codec = Numbers3(kOne, Between(-1e6, 1e6));
  codec.type = "direction of 3 numbers, not all 0";
  codec.read = [numbers = codec.read, type = codec.type](const Value& value, const Context& context,
                                                         Eigen::Vector3d& result) {
    const size_t problems_before = context.problems.size();
    Eigen::Vector3d direction;
    numbers(value, context, direction);
    if (context.problems.size() != problems_before) return;
    const double length = direction.stableNorm();
    if (!(length > 0) || !std::isfinite(length)) return context.AddWrong(value, type);
    // A unit vector stays as it is, so that a written setting reads back to the same bits.
    result = std::abs(length - 1) < 1e-14 ? direction : Eigen::Vector3d(direction / length);
  };
  return codec;
}

Codec<std::array<int, 6>> Signs() {
  const Codec<int> item = Integer(-1, 1);
  Codec<std::array<int, 6>> codec;
  codec.type = "list of 6 signs, each 1 or -1";
  codec.schema = [] {
    Value sign = codec_detail::SchemaOf("integer");
    sign.Put("enum", Value::List({Value::Plain("-1"), Value::Plain("1")}));
    return codec_detail::ListSchema(sign, 6, 6);
  };
  codec.read = [item, type = codec.type](const Value& value, const Context& context,
                                         std::array<int, 6>& result) {
    std::array<int, 6> signs{};
    const size_t problems_before = context.problems.size();
    ReadItems(value, context, 6, type, item, [&](size_t i) -> int& { return signs[i]; });
    if (context.problems.size() != problems_before) return;
    const auto zero = std::ranges::find(signs, 0);
    if (zero != signs.end()) {
      const size_t i = zero - signs.begin();
      return context.Child(i).AddWrong(value.items[i], "1 or -1");
    }
    result = signs;
  };
  codec.write = [item](const std::array<int, 6>& signs) {
    Value list = Value::List();
    for (const int sign_value : signs) list.items.push_back(item.write(sign_value));
    return list;
  };
  return codec;
}

Codec<std::array<Six, 2>> Limits() {
  const Codec<double> angle = Real(kDeg, Between(-720, 720));
  const std::string pair_type = "[lower, upper] in deg, lower < upper";
  Codec<std::array<Six, 2>> codec;
  codec.type = "list of 6 pairs " + pair_type;
  codec.schema = [angle] {
    return codec_detail::ListSchema(codec_detail::ListSchema(angle.schema(), 2, 2), 6, 6);
  };
  codec.read = [=, type = codec.type](const Value& value, const Context& context,
                                      std::array<Six, 2>& result) {
    if (value.kind != Value::Kind::kList || value.items.size() != 6) return context.AddWrong(value, type);
    for (size_t i = 0; i < 6; ++i) {
      const size_t problems_before = context.problems.size();
      const Context joint = context.Child(i);
      std::array<double, 2> pair{};
      ReadItems(value.items[i], joint, 2, pair_type, angle, [&](size_t k) -> double& { return pair[k]; });
      if (context.problems.size() != problems_before) continue;
      if (!(pair[0] < pair[1]))
        joint.Add(value.items[i].mark,
                  fmt::format("given {}; allowed: {}", WriteYamlLine(value.items[i]), pair_type));
      result[0][i] = pair[0];
      result[1][i] = pair[1];
    }
  };
  codec.write = [angle](const std::array<Six, 2>& limits) {
    Value list = Value::List();
    for (int i = 0; i < 6; ++i)
      list.items.push_back(Value::List({angle.write(limits[0][i]), angle.write(limits[1][i])}));
    return list;
  };
  return codec;
}

Codec<std::pair<std::string, std::string>> NamePair() {
  using Pair = std::pair<std::string, std::string>;
  const Codec<std::string> name = Text();
  Codec<Pair> codec;
  codec.type = "pair of names [first, second]";
  codec.schema = [name] { return codec_detail::ListSchema(name.schema(), 2, 2); };
  codec.read = [name, type = codec.type](const Value& value, const Context& context, Pair& result) {
    ReadItems(value, context, 2, type, name,
              [&](size_t i) -> std::string& { return i == 0 ? result.first : result.second; });
  };
  codec.write = [](const Pair& pair) {
    return Value::List({Value::Text(pair.first), Value::Text(pair.second)});
  };
  return codec;
}

}  // namespace millpose::yaml
