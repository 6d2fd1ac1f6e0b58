// SPDX-License-Identifier: GPL-3.0-or-later
// What several tables use.
#include "job/config/fields.hpp"

namespace millpose::config {
namespace {

constexpr struct {
  const char* name;
  double mm;
} kLengthUnits[] = {{"mm", 1}, {"cm", 10}, {"in", 25.4}, {"m", 1000}};

}  // namespace

Codec<double> LengthUnit() {
  std::vector<std::string> names;
  for (const auto& unit : kLengthUnits) names.emplace_back(unit.name);
  const Codec<std::string> name = Choice(names);
  Codec<double> codec;
  codec.type = name.type;
  codec.schema = name.schema;
  codec.read = [name](const Value& value, const Context& context, double& result) {
    std::string given;
    name.read(value, context, given);
    for (const auto& unit : kLengthUnits)
      if (given == unit.name) result = unit.mm;
  };
  codec.write = [name](double mm) {
    const auto* unit = std::ranges::find(kLengthUnits, mm, [](const auto& known) { return known.mm; });
    return unit == std::end(kLengthUnits) ? Value() : name.write(unit->name);
  };
  return codec;
}

Value WordSchema() {
  Value schema = codec_detail::SchemaOf("string");
  schema.Put("pattern", Value::Text("^[A-Za-z][A-Za-z0-9_-]*$"));
  return schema;
}

Value NamedMapsSchema(const Value& properties, size_t most) {
  Value map = codec_detail::SchemaOf("object");
  map.Put("properties", properties);
  map.Put("required", Value::List({Value::Text("name")}));
  map.Put("additionalProperties", Value::Plain("false"));
  return codec_detail::ListSchema(map, 1, most);
}

}  // namespace millpose::config
