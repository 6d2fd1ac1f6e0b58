// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a job's `pose:` and `limits:`, one line each.
#include "job/config/fields.hpp"
#include "planning/pose/expression.hpp"

namespace millpose::config {
namespace {

template <class S>
void CheckElite(const Value& value, const Context& context, S& search) {
  if (search.elite >= search.population)
    context.Child("elite").Add(value.mark, fmt::format("given {}; allowed: less than population, {}",
                                                       search.elite, search.population));
}

Codec<GeneticOptions> GeneticFields() {
  using S = GeneticOptions;
  return Section<S>(
      {
          Key<S>("table", MILLPOSE_AT(table), Integer(0, 100000),
                 "Settings of the coarse table that half of the first generation is chosen from; 0: all of "
                 "it is "
                 "drawn at random."),
          Key<S>("population", MILLPOSE_AT(population), Integer(2, 100000),
                 "Candidates of a generation, for each freedom."),
          Key<S>("generations", MILLPOSE_AT(generations), Integer(1, 100000),
                 "Most generations, for each freedom."),
          Key<S>("crossover_rate", MILLPOSE_AT(crossover_rate), Real(kOne, Between(0, 1)),
                 "Share of children with two parents."),
          Key<S>("mutation_rate", MILLPOSE_AT(mutation_rate), Real(kOne, Between(0, 1)),
                 "Share of children that are changed at random."),
          Key<S>("elite", MILLPOSE_AT(elite), Integer(0, 100000), "Best candidates kept as they are."),
          Key<S>("max_evaluations", MILLPOSE_AT(max_evaluations), Integer(10, 10000000),
                 "Most evaluations of the objective for one point."),
      },
      CheckElite<S>);
}

Codec<PaperFormulationOptions> PaperFields() {
  using S = PaperFormulationOptions;
  const Unit compliance{"mm/N", 1, 1};
  return Section<S>(
      {
          Key<S>("population", MILLPOSE_AT(population), Integer(2, 100000), "Candidates of a generation."),
          Key<S>("generations", MILLPOSE_AT(generations), Integer(1, 100000), "Generations."),
          Key<S>("elite", MILLPOSE_AT(elite), Integer(1, 100000), "Best candidates kept as they are."),
          Key<S>("crossover_rate", MILLPOSE_AT(crossover_rate), Real(kOne, Between(0, 1)),
                 "Share of children with two parents; the others are changed at random."),
          Key<S>("c_max_mm_N", MILLPOSE_AT(c_max), Real(compliance, Positive(1)),
                 "Objective at which the fitness begins (eq. 29)."),
          Key<S>("penalty_mm_N", MILLPOSE_AT(penalty), Real(compliance, UpTo(1)),
                 "Loss of fitness per squared error, errors in units of the tolerance (eq. 32-35)."),
      },
      CheckElite<S>);
}

// {name: …, further keys: numbers}: the parameters that the objective's entry names.
using Objective = std::pair<std::string, ObjectiveParameters>;

// What is wrong with an expression, each at its place; beside it there is no key.
void ReadExpression(const Value& value, const Context& context, Objective& objective) {
  const Value& text = *value.Find("expression");
  const Context place = context.Child("expression");
  for (const Value::Key& key : value.keys)
    if (key.text != "expression")
      context.Child(key.text).Add(key.mark, "has no effect beside expression; allowed: expression alone");
  if (text.kind != Value::Kind::kScalar) return place.AddWrong(text, "text: an expression of indices");
  try {
    if (!Expression::Looks(text.text))
      return place.Add(text.mark, UnknownName("index or function", text.text, Expression::Names()));
    static_cast<void>(Expression(text.text));
    objective = {text.text, {}};
  } catch (const InputError& error) {
    for (const Problem& problem : error.problems()) place.Add(text.mark, problem.message);
  }
}

// The rule of the parameter `key` of the objective `name`; nullptr where it has none.
const ParameterRule* RuleOf(const std::string& name, const std::string& key) {
  for (const ObjectiveEntry& entry : Objectives().entries())
    if (entry.name == name)
      for (const ParameterRule& rule : entry.parameters)
        if (rule.name == key) return &rule;
  return nullptr;
}

// A parameter that is one of the words, as the word's index.
Codec<double> WordOf(const std::vector<std::string>& words) {
  std::vector<std::pair<std::string, double>> choices;
  for (size_t i = 0; i < words.size(); ++i) choices.emplace_back(words[i], static_cast<double>(i));
  return ChoiceOf<double>(choices);
}

// What the objective does not know, and values below what it allows.
void CheckParameters(const Value& value, const Context& context, const Objective& objective) {
  std::vector<std::string> known;
  for (const ParameterRule& rule : Objectives().At(objective.first).parameters) {
    if (std::ranges::find(kForceBounds, rule.name) != kForceBounds.end()) continue;
    known.push_back(rule.name);
    const Value* given = value.Find(rule.name);
    if (given != nullptr && objective.second.at(rule.name) < rule.minimum)
      context.Child(rule.name).AddWrong(*given, fmt::format("at least {}", rule.minimum));
  }
  for (const Value::Key& key : value.keys)
    if (std::ranges::find(kForceBounds, key.text) != kForceBounds.end())
      context.Child(key.text).Add(key.mark, "unknown key; it is one of `process`");
    else if (key.text != "name" && std::ranges::find(known, key.text) == known.end())
      context.Child(key.text).Add(key.mark, UnknownName("parameter", key.text, known));
}

Codec<Objective> ObjectiveFields() {
  const Codec<std::string> name = Choice(Objectives().Names());
  const Codec<double> number = Real(kOne, Between(-1e6, 1e6));
  Codec<Objective> codec;
  codec.type = "map of name and the objective's parameters, or of expression";
  const Codec<std::string> text = Text();
  const auto parameter_of = [number](const std::string& objective, const std::string& key) {
    const ParameterRule* rule = RuleOf(objective, key);
    return rule && !rule->words.empty() ? WordOf(rule->words) : number;
  };
  codec.schema = [=] {
    std::vector<FieldInfo> rows{{"name", name.type, "", "Name of the objective.", false, {}, "expression"},
                                {"expression",
                                 text.type,
                                 "",
                                 "An objective spelled by named indices (docs/objective-expression.md).",
                                 false,
                                 {}}};
    std::vector<Value> schemas{name.schema(), text.schema()};
    for (const ObjectiveEntry& entry : Objectives().entries())
      for (const ParameterRule& rule : entry.parameters) {
        if (rule.words.empty() || std::ranges::find(rows, rule.name, &FieldInfo::key) != rows.end()) continue;
        const Codec<double> word = WordOf(rule.words);
        rows.push_back({rule.name, word.type, "", rule.doc, false, {}});
        schemas.push_back(word.schema());
      }
    Value schema = codec_detail::SectionSchema(rows, schemas, std::vector<Value>(rows.size()));
    schema.items.back() = number.schema();  // additionalProperties
    return schema;
  };
  codec.read = [=](const Value& value, const Context& context, Objective& result) {
    if (value.kind != Value::Kind::kMap) return context.AddWrong(value, "a map of keys");
    if (value.Find("expression")) return ReadExpression(value, context, result);
    const Value* named = value.Find("name");
    if (!named) context.Child("name").Add(value.mark, "missing; required: " + name.type);
    const size_t problems_before = context.problems.size();
    result.second.clear();
    if (named) name.read(*named, context.Child("name"), result.first);
    for (size_t i = 0; i < value.items.size(); ++i) {
      const std::string& key = value.keys[i].text;
      if (key != "name")
        parameter_of(result.first, key).read(value.items[i], context.Child(key), result.second[key]);
    }
    if (context.problems.size() == problems_before) CheckParameters(value, context, result);
  };
  codec.write = [=](const Objective& objective) {
    Value map = Value::Map();
    const bool spelled = Expression::Looks(objective.first);
    map.Put(spelled ? "expression" : "name",
            spelled ? text.write(objective.first) : name.write(objective.first));
    for (const auto& [key, parameter] : objective.second)
      map.Put(key, parameter_of(objective.first, key).write(parameter));
    return map;
  };
  return codec;
}

// The paper's fitness knows eq. 23 alone.
void CheckFormulation(const Value& value, const Context& context, JobSettings& job) {
  if (job.formulation != Formulation::kPaper) return;
  const Value::Key* key = value.FindKey("formulation");
  const bool normalised =
      job.objective_parameters.contains("reference_t2") || job.objective_parameters.contains("reference_n");
  const std::string& papers = TheObjective(&ObjectiveEntry::of_paper).name;
  if (job.objective != papers || normalised)
    context.Child("formulation")
        .Add(key ? key->mark : value.mark,
             fmt::format("given paper; allowed only with objective {} without references, given {}{}", papers,
                         job.objective, normalised ? " with references" : ""));
}

}  // namespace

Codec<JobSettings> PoseSearchFields() {
  using S = JobSettings;
  return Section<S>(
      {
          KeyBy<S, Objective>(
              "objective",
              [](const S& s) {
                return Objective{s.objective, s.objective_parameters};
              },
              [](S& s, const Objective& objective) {
                s.objective = objective.first;
                s.objective_parameters = objective.second;
              },
              ObjectiveFields(),
              "What is minimised at each point; by default drilling with strategy drill, face_error where "
              "`process.cutting` is given and the cell knows its gears' lost motion, surface_error where it "
              "does not, else chen2021.")
              .DefaultText(""),
          Key<S>(
              "formulation", MILLPOSE_AT(formulation),
              ChoiceOf<Formulation>({{"freedoms", Formulation::kFreedoms}, {"paper", Formulation::kPaper}}),
              "What the genetic algorithm varies: the freedoms of a point, or, to compare, the six joint "
              "angles of Chen et al. 2021."),
          Key<S>("genetic", MILLPOSE_AT(path.genetic), GeneticFields(), "The genetic algorithm per point."),
          Key<S>("paper", MILLPOSE_AT(paper), PaperFields(), "Formulation paper."),
          Key<S>("exhaustive_step_deg", MILLPOSE_AT(exhaustive_step), Real(kDeg, Between(0.001, 30)),
                 "Grid of the exhaustive search by which --audit judges the genetic algorithm."),
      },
      CheckFormulation);
}

Codec<JobSettings> LimitFields() {
  using S = JobSettings;
  return Section<S>({
      Key<S>("margin_deg", MILLPOSE_AT(limit_margin), Real(kDeg, Between(0, 45)),
             "Distance that every axis keeps from its limits."),
      Key<S>("dexterity_min", MILLPOSE_AT(dexterity_min), Real(kOne, Between(0, 1)), "Least dexterity."),
      Key<S>("singularity_min", kSelf,
             Section<S>({
                 Key<S>("wrist", MILLPOSE_AT(wrist_min), Real(kOne, Between(0, 1)), "Least |sin A5|."),
                 Key<S>("elbow", MILLPOSE_AT(elbow_min), Real(kOne, Between(0, 1)),
                        "Least |sin| of the angle between upper arm and forearm."),
                 Key<S>("shoulder_mm", MILLPOSE_AT(shoulder_min), Real(kMm, UpTo(1e4)),
                        "Least distance of the wrist centre from axis 1, dy aside."),
             }),
             "Distances kept from singularities."),
      Key<S>("joints_deg", MILLPOSE_AT(task_limits), Maybe(Limits()),
             "Narrows the arm's own limits for this job."),
  });
}

}  // namespace millpose::config
