// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/spec.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include <trellis/base/random.hpp>
#include <trellis/guide/custom.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/planner/planner.hpp>
#include <trellis/strategy/lengths.hpp>
#include <trellis/strategy/registry.hpp>

namespace trellis {

namespace {

using Json = nlohmann::ordered_json;

/// The options that differ from their defaults, as "name = value". Positional options come first, always, and without
/// names, because they identify the component.
std::vector<std::string> written_options(const Component& component, const Options& options,
                                         std::vector<std::string> unnamed, bool& named) {
  std::vector<std::string> rest;
  for (const auto& [name, value] : options.entries()) {
    const auto& positional = component.positional;
    if (std::find(positional.begin(), positional.end(), name) != positional.end()) {
      if (const auto* names = std::get_if<std::vector<std::string>>(&value)) {
        for (const auto& element : *names) unnamed.push_back(to_string(OptionValue(element)));
      } else {
        unnamed.push_back(to_string(value));
      }
    } else if (!(value == component.find(name)->default_value)) {
      rest.push_back(fmt::format("{} = {}", name, to_string(value)));
    }
  }
  named = !rest.empty();
  for (auto& text : rest) unnamed.push_back(std::move(text));
  return unnamed;
}

std::string options_text(const Component& component, const Options& options, const std::string& more) {
  bool named = false;
  std::vector<std::string> written = written_options(component, options, {}, named);
  if (!more.empty()) written.push_back(more);
  if (!named && more.empty()) return fmt::format("({})", fmt::join(written, ", "));
  return fmt::format(" {{ {} }}", fmt::join(written, ", "));
}

/// "schedule { a, b, turn = 300 }".
std::string combined_text(const Component& component, const Options& options, std::vector<std::string> parts) {
  bool named = false;
  return fmt::format("{} {{ {} }}", component.name,
                     fmt::join(written_options(component, options, std::move(parts), named), ", "));
}

const Component& combinator(GuideSpec::Kind kind) {
  switch (kind) {
    case GuideSpec::Kind::sequence: return sequence_settings().component();
    case GuideSpec::Kind::blend: return blend_settings().component();
    case GuideSpec::Kind::schedule: return schedule_settings().component();
    case GuideSpec::Kind::race: return race_settings().component();
    case GuideSpec::Kind::component:
    case GuideSpec::Kind::mixture: break;
  }
  throw Fault("no combinator with options");
}

Options sequence_options(std::int64_t turn) {
  return Options::validate(sequence_settings().component(), {{"turn", turn}});
}

double total_weight(const GuideSpec& guide) {
  double total = 0.0;
  for (const auto& term : guide.terms()) total += term.weight;
  return total;
}

/// The normalised weights of a mixture, with enough digits to parse to an equal mixture. A single part has the weight
/// that it was given, because its share is always 1.
std::vector<std::string> written_weights(const GuideSpec& guide) {
  if (guide.terms().size() == 1) return {to_string(OptionValue(guide.terms().front().weight))};
  const double total = total_weight(guide);
  const auto write = [&](const char* format) {
    std::vector<std::string> written;
    for (const auto& term : guide.terms()) written.push_back(fmt::format(fmt::runtime(format), term.weight / total));
    return written;
  };
  std::vector<std::string> written = write("{:.4g}");
  double read = 0.0;
  for (const auto& text : written) read += parse_number(text);
  for (std::size_t i = 0; i < written.size(); ++i) {
    if (std::abs(parse_number(written[i]) / read - guide.terms()[i].weight / total) > 1e-13) return write("{:.17g}");
  }
  return written;
}

/// Whether its text contains an operator and so needs parentheses inside other expressions.
bool is_open(const GuideSpec& guide) {
  switch (guide.kind()) {
    case GuideSpec::Kind::component: return guide.below() != nullptr;
    case GuideSpec::Kind::mixture: return true;
    case GuideSpec::Kind::sequence:
      return guide.options() == sequence_options(default_turn) && guide.terms().size() > 1;
    case GuideSpec::Kind::blend:
    case GuideSpec::Kind::schedule:
    case GuideSpec::Kind::race: return false;
  }
  throw Fault("unknown kind of guide");
}

std::string bracketed(const GuideSpec& guide) {
  return is_open(guide) ? fmt::format("({})", guide.text()) : guide.text();
}

/// The text before `>>`. This operator is associative and binds weaker than the combining operators.
std::string in_front(const GuideSpec& guide) {
  return guide.kind() == GuideSpec::Kind::component ? guide.text() : bracketed(guide);
}

Json value_json(const OptionValue& value) {
  return std::visit(
      [](const auto& v) -> Json {
        if constexpr (std::is_same_v<std::decay_t<decltype(v)>, double>) {
          if (std::isinf(v)) return nullptr;  // no limit
        }
        return v;
      },
      value);
}

Json options_json(const Options& options) {
  Json json = Json::object();
  for (const auto& [name, value] : options.entries()) json[name] = value_json(value);
  return json;
}

Json planner_json(const PlannerSpec& planner) {
  if (const Options* dividing = planner.dividing()) {
    Json json = {{"split", planner_json(planner.undivided())}};
    json.update(options_json(*dividing));
    return json;
  }
  return {{"planner", planner.name()}, {"options", options_json(planner.options())}};
}

using PlannersAbove = std::vector<const PlannerSpec*>;

/// The planner that searches the space of a component. \param above  the planners of the levels above, the root's first
PlannerSpec searching_planner(const GuideSpec& guide, const PlannersAbove& above) {
  return guide.planner_given() ? *guide.planner() : with_lengths_of(above, *guide.planner());
}

PlannersAbove with(PlannersAbove above, const PlannerSpec& planner) {
  above.push_back(&planner);
  return above;
}

Json guide_json(const GuideSpec& guide, const PlannersAbove& above) {
  if (guide.kind() == GuideSpec::Kind::component) {
    Json json = {{"guide", guide.name()}};
    if (guide.custom()) {
      json["custom"] = guide.custom()->description().identity;
    } else {
      json["options"] = options_json(guide.options());
    }
    if (!guide.planner()) return json;
    const PlannerSpec planner = searching_planner(guide, above);
    json["search"] = planner_json(planner);
    if (guide.below() != nullptr) json["guided_by"] = guide_json(*guide.below(), with(above, planner));
    return json;
  }
  Json parts = Json::array();
  const double total = total_weight(guide);
  for (const auto& term : guide.terms()) {
    if (guide.kind() == GuideSpec::Kind::mixture) {
      parts.push_back({{"weight", term.weight / total}, {"guide", guide_json(term.guide, above)}});
    } else {
      parts.push_back(guide_json(term.guide, above));
    }
  }
  Json json = {{guide.name(), parts}};
  json.update(options_json(guide.options()));
  return json;
}

}  // namespace

// ---- planners

PlannerSpec PlannerSpec::make(const std::string& name, const std::vector<Options::Entry>& given, Origin origin) {
  const Component& described = component(Component::Kind::planner, name);
  PlannerSpec spec;
  spec.name_ = name;
  spec.options_ = Options::validate(described, given);
  spec.origin_ = std::move(origin);
  return spec;
}

struct PlannerSpec::Division {
  Options options;
  PlannerSpec part;
};

const Options* PlannerSpec::dividing() const { return division_ ? &division_->options : nullptr; }

const PlannerSpec& PlannerSpec::undivided() const {
  if (!division_) throw Fault("not a split");
  return division_->part;
}

PlannerSpec PlannerSpec::half() const {
  SplitSettings settings = split_settings().read(*dividing());
  if (--settings.depth == 0) return division_->part;
  return split(division_->part, settings);
}

PlannerSpec PlannerSpec::with(const std::string& option, const OptionValue& value) const {
  std::vector<Options::Entry> given = options_.entries();
  std::erase_if(given, [&](const Options::Entry& entry) { return entry.first == option; });
  given.emplace_back(option, value);
  PlannerSpec spec = make(name_, given, origin_);
  if (division_) {
    spec.division_ = std::make_shared<Division>(Division{division_->options, division_->part.with(option, value)});
  }
  return spec;
}

std::string PlannerSpec::text() const {
  if (division_) return combined_text(split_settings().component(), division_->options, {division_->part.text()});
  return name_ + options_text(component(Component::Kind::planner, name_), options_, "");
}

bool operator==(const PlannerSpec& a, const PlannerSpec& b) {
  if ((a.division_ == nullptr) != (b.division_ == nullptr)) return false;
  if (a.division_) return a.division_->options == b.division_->options && a.division_->part == b.division_->part;
  return a.name_ == b.name_ && a.options_ == b.options_;
}

PlannerSpec split(const PlannerSpec& part, const SplitSettings& settings) {
  if (find_planner(part.name())->graph) {
    throw Error(fmt::format("split: '{}' searches explicit graphs, which need no sub-goals", part.name()));
  }
  SplitSettings whole = settings;
  const PlannerSpec* leaf = &part;
  if (part.division_) {
    const SplitSettings inner = split_settings().read(part.division_->options);
    if (inner.tries == settings.tries && inner.effort == settings.effort) {
      whole.depth += inner.depth;
      leaf = &part.division_->part;
    }
  }
  PlannerSpec spec = part;
  spec.division_ = std::make_shared<PlannerSpec::Division>(PlannerSpec::Division{
      Options::validate(split_settings().component(),
                        {{"depth", whole.depth}, {"tries", whole.tries}, {"effort", whole.effort}}),
      *leaf});
  return spec;
}

// ---- guides

struct GuideSpec::Node {
  Kind kind = Kind::component;
  std::string name;
  std::string text_alone;  ///< of a component: its text without planner and guide below
  Options options;
  std::shared_ptr<const CustomGuide> custom;
  std::optional<PlannerSpec> planner;
  bool planner_given = false;  ///< the author of the spec chose it
  std::optional<GuideSpec> below;
  Origin origin;
  std::vector<Term> terms;

  /// Selects the planner of its space's search.
  /// \param either  whether the space has an optional graph, which the planner may search or ignore
  /// \param given  the author's choice, if any
  void search_by(const std::string& default_planner, bool either, std::optional<PlannerSpec> given);
};

void GuideSpec::Node::search_by(const std::string& default_planner, bool either, std::optional<PlannerSpec> given) {
  if (default_planner.empty()) {
    if (given) throw Error(fmt::format("{}: has no space to search (S = {{0}}), so it takes no planner", name));
    return;
  }
  const bool graph = find_planner(default_planner)->graph;
  if (given && !either && find_planner(given->name())->graph != graph) {
    throw Error(graph ? fmt::format("{}: its space is an explicit graph; '{}' cannot search it (expected planner = "
                                    "graph_search or best_first)",
                                    name, given->name())
                      : fmt::format("{}: its space is no explicit graph; '{}' cannot search it (expected a sampling "
                                    "planner such as {})",
                                    name, given->name(), default_planner));
  }
  planner_given = given.has_value();
  planner = given ? std::move(given) : PlannerSpec::make(default_planner, {});
}

GuideSpec GuideSpec::make(const std::string& name, const std::vector<Options::Entry>& given,
                          std::optional<PlannerSpec> planner, Origin origin) {
  const Component& described = component(Component::Kind::guide, name);
  const GuideKind& kind = *find_guide(name);
  auto node = std::make_shared<Node>();
  node->name = name;
  node->options = Options::validate(described, given);
  node->origin = std::move(origin);
  node->search_by(kind.default_planner, kind.graph_optional, std::move(planner));
  node->text_alone = text_of_component(*node, "");
  return GuideSpec(std::move(node));
}

GuideSpec GuideSpec::make(std::shared_ptr<const CustomGuide> custom, std::optional<PlannerSpec> planner,
                          Origin origin) {
  auto node = std::make_shared<Node>();
  node->name = custom->description().name;
  node->origin = std::move(origin);
  node->search_by(custom->description().default_planner, false, std::move(planner));
  node->custom = std::move(custom);
  node->text_alone = text_of_component(*node, "");
  return GuideSpec(std::move(node));
}

GuideSpec::Kind GuideSpec::kind() const { return node_->kind; }
const std::string& GuideSpec::name() const { return node_->name; }
const Options& GuideSpec::options() const { return node_->options; }
const std::optional<PlannerSpec>& GuideSpec::planner() const { return node_->planner; }
bool GuideSpec::planner_given() const { return node_->planner_given; }
const std::shared_ptr<const CustomGuide>& GuideSpec::custom() const { return node_->custom; }
const GuideSpec* GuideSpec::below() const { return node_->below ? &*node_->below : nullptr; }
const Origin& GuideSpec::origin() const { return node_->origin; }
const std::vector<GuideSpec::Term>& GuideSpec::terms() const { return node_->terms; }

std::optional<GuideSpec> GuideSpec::with_parts(const std::vector<std::optional<GuideSpec>>& parts) const {
  std::vector<GuideSpec> kept;
  std::optional<GuideSpec> sum;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!parts[i]) continue;
    kept.push_back(*parts[i]);
    // A mixture that replaces a part gets that part's weight in total.
    const double within = parts[i]->kind() == Kind::mixture ? total_weight(*parts[i]) : 1.0;
    const GuideSpec weighted = (terms()[i].weight / within) * *parts[i];
    sum = sum ? *sum + weighted : weighted;
  }
  if (kept.empty()) return std::nullopt;
  if (kind() != Kind::mixture) return combine(kind(), kept, options());
  return kept.size() == 1 ? kept.front() : sum;
}

/// Combines guides. A schedule or race of one guide is that guide; a blend, whose options also apply to a single guide,
/// and a sequence are not.
GuideSpec GuideSpec::combine(Kind kind, const std::vector<GuideSpec>& parts, Options options) {
  const std::string& name = combinator(kind).name;
  if (parts.empty()) throw Error(name + ": needs at least one guide");
  if (parts.size() == 1 && (kind == Kind::schedule || kind == Kind::race)) return parts.front();
  // Nested schedules are flattened only without turns: otherwise the turns would change.
  const bool flat =
      kind == Kind::sequence || (kind == Kind::schedule && std::isinf(schedule_settings().read(options).turn));
  auto node = std::make_shared<Node>();
  node->kind = kind;
  node->name = name;
  for (const auto& part : parts) {
    if (flat && part.kind() == kind && part.options() == options) {
      node->terms.insert(node->terms.end(), part.terms().begin(), part.terms().end());
    } else {
      node->terms.push_back({1.0, part});
    }
  }
  node->options = std::move(options);
  return GuideSpec(std::move(node));
}

GuideSpec GuideSpec::alone() const {
  return node_->custom ? make(node_->custom, {}, node_->origin) : make(name(), options().entries(), {}, node_->origin);
}

bool GuideSpec::searches() const {
  if (kind() == Kind::component) return node_->planner.has_value();
  return std::any_of(terms().begin(), terms().end(), [](const Term& term) { return term.guide.searches(); });
}

std::string GuideSpec::text_of_component(const Node& node, const std::string& planner) {
  if (!node.custom) {
    return node.name + options_text(component(Component::Kind::guide, node.name), node.options, planner);
  }
  return planner.empty() ? node.name : fmt::format("{} {{ {} }}", node.name, planner);
}

std::string GuideSpec::text_alone() const { return node_->text_alone; }

std::string GuideSpec::text() const {
  switch (kind()) {
    case Kind::component: {
      std::string self = text_of_component(*node_, node_->planner_given ? "planner = " + node_->planner->text() : "");
      if (!node_->below) return self;
      return in_front(*node_->below) + " >> " + self;
    }
    case Kind::mixture: {
      const std::vector<std::string> weights = written_weights(*this);
      std::vector<std::string> parts;
      for (const auto& term : terms()) parts.push_back(weights[parts.size()] + "*" + bracketed(term.guide));
      return fmt::format("{}", fmt::join(parts, " + "));
    }
    case Kind::sequence:
      if (is_open(*this)) {
        std::vector<std::string> parts;
        for (const auto& term : terms()) parts.push_back(bracketed(term.guide));
        return fmt::format("{}", fmt::join(parts, " .. "));
      }
      [[fallthrough]];
    case Kind::blend:
    case Kind::schedule:
    case Kind::race: {
      std::vector<std::string> parts;
      parts.reserve(terms().size());
      for (const auto& term : terms()) parts.push_back(term.guide.text());
      return combined_text(combinator(kind()), options(), std::move(parts));
    }
  }
  throw Fault("unknown kind of guide");
}

bool operator==(const GuideSpec& a, const GuideSpec& b) {
  if (a.node_ == b.node_) return true;
  if (a.kind() != b.kind()) return false;
  if (a.kind() == GuideSpec::Kind::component) {
    if (a.name() != b.name() || !(a.options() == b.options()) || !(a.planner() == b.planner())) return false;
    if ((a.custom() == nullptr) != (b.custom() == nullptr)) return false;
    if (a.custom() && a.custom()->description().identity != b.custom()->description().identity) return false;
    if ((a.below() == nullptr) != (b.below() == nullptr)) return false;
    return a.below() == nullptr || *a.below() == *b.below();
  }
  if (a.terms().size() != b.terms().size() || !(a.options() == b.options())) return false;
  const double total_a = total_weight(a);
  const double total_b = total_weight(b);
  for (std::size_t i = 0; i < a.terms().size(); ++i) {
    // Weights are equal if they are equal after normalisation, up to rounding: 0.5*a + 0.5*b is a + b.
    if (std::abs(a.terms()[i].weight / total_a - b.terms()[i].weight / total_b) > 1e-12) return false;
    if (!(a.terms()[i].guide == b.terms()[i].guide)) return false;
  }
  return true;
}

GuideSpec operator>>(const GuideSpec& above, const GuideSpec& guided) {
  if (!guided.searches()) {
    throw Error(
        fmt::format("{} >> {}: '{}' searches no space (S = {{0}}), so there is nothing to guide; mix them "
                    "instead: {} + {}",
                    above.text(), guided.text(), guided.text(), above.text(), guided.text()));
  }
  auto node = std::make_shared<GuideSpec::Node>(*guided.node_);
  if (guided.kind() == GuideSpec::Kind::component) {
    node->below = guided.below() != nullptr ? above >> *guided.below() : above;
    if (!node->planner_given && !node->custom) {
      const GuideKind& kind = *find_guide(node->name);
      const auto& [planner, options] = kind.guided_planner;
      if (!planner.empty()) node->planner = PlannerSpec::make(planner, options);
    }
  } else {
    for (auto& term : node->terms) {
      if (term.guide.searches()) term.guide = above >> term.guide;
    }
  }
  return GuideSpec(std::move(node));
}

GuideSpec operator+(const GuideSpec& a, const GuideSpec& b) {
  auto node = std::make_shared<GuideSpec::Node>();
  node->kind = GuideSpec::Kind::mixture;
  node->name = "mixture";
  for (const auto* side : {&a, &b}) {
    if (side->kind() == GuideSpec::Kind::mixture) {
      node->terms.insert(node->terms.end(), side->terms().begin(), side->terms().end());
    } else {
      node->terms.push_back({1.0, *side});
    }
  }
  return GuideSpec(std::move(node));
}

GuideSpec operator*(double weight, const GuideSpec& guide) {
  if (!std::isfinite(weight) || weight <= 0.0) {
    throw Error(fmt::format("{:g} * {}: a weight must be a finite number greater than 0", weight, guide.text()));
  }
  auto node = std::make_shared<GuideSpec::Node>();
  node->kind = GuideSpec::Kind::mixture;
  node->name = "mixture";
  if (guide.kind() == GuideSpec::Kind::mixture) {
    for (const auto& term : guide.terms()) node->terms.push_back({weight * term.weight, term.guide});
  } else {
    node->terms.push_back({weight, guide});
  }
  return GuideSpec(std::move(node));
}

GuideSpec sequence(const std::vector<GuideSpec>& parts, std::int64_t turn) {
  return GuideSpec::combine(GuideSpec::Kind::sequence, parts, sequence_options(turn));
}

GuideSpec blend(const std::vector<GuideSpec>& parts, const BlendSettings& settings) {
  if (settings.credit == "efficiency" && settings.rule == "exp3") {
    throw Error(
        "blend: credit = \"efficiency\" has a rule of its own and cannot be combined with rule = \"exp3\"; give one of "
        "the two");
  }
  return GuideSpec::combine(GuideSpec::Kind::blend, parts,
                            Options::validate(blend_settings().component(), {{"floor", settings.floor},
                                                                             {"decay", settings.decay},
                                                                             {"credit", settings.credit},
                                                                             {"rule", settings.rule}}));
}

GuideSpec schedule(const std::vector<GuideSpec>& parts, const ScheduleSettings& settings) {
  return GuideSpec::combine(
      GuideSpec::Kind::schedule, parts,
      Options::validate(schedule_settings().component(), {{"rounds", settings.rounds}, {"turn", settings.turn}}));
}

GuideSpec race(const std::vector<GuideSpec>& parts, const RaceSettings& settings) {
  return GuideSpec::combine(GuideSpec::Kind::race, parts,
                            Options::validate(race_settings().component(), {{"slice", settings.slice}}));
}

// ---- strategies

namespace {

void check_root(const PlannerSpec& planner) {
  if (find_planner(planner.name())->graph) {
    throw Error(
        fmt::format("'{}' searches explicit graphs; the root of a strategy is a configuration space and needs a "
                    "sampling planner such as rrt",
                    planner.name()));
  }
}

void draw(const GuideSpec& guide, const PlannersAbove& above, const std::string& label, const std::string& indent,
          bool last, std::string& out) {
  const auto head = [&](const std::string& text) { out += indent + (last ? "└─ " : "├─ ") + label + text + "\n"; };
  const std::string deeper = indent + (last ? "   " : "│  ");
  if (guide.kind() == GuideSpec::Kind::component) {
    if (!guide.planner()) {
      head(guide.text_alone() + "  S = {0}");
      return;
    }
    const PlannerSpec planner = searching_planner(guide, above);
    head(guide.text_alone() + "  searched by " + planner.text());
    if (guide.below() != nullptr) draw(*guide.below(), with(above, planner), "", deeper, true, out);
    return;
  }
  const bool mixture = guide.kind() == GuideSpec::Kind::mixture;
  if (guide.kind() == GuideSpec::Kind::sequence) {
    head(fmt::format("sequence, turns of {} proposals", sequence_settings().read(guide.options()).turn));
  } else {
    std::string line = guide.name();
    for (const auto& [name, value] : guide.options().entries()) {
      const auto* text = std::get_if<std::string>(&value);
      const auto* number = std::get_if<double>(&value);
      line += fmt::format(", {} {}", name,
                          text != nullptr     ? *text
                          : number != nullptr ? fmt::format("{:.3g}", *number)
                                              : to_string(value));
    }
    head(line);
  }
  // A single part has the weight that it was given (written_weights).
  const double total = guide.terms().size() == 1 ? 1.0 : total_weight(guide);
  for (std::size_t i = 0; i < guide.terms().size(); ++i) {
    const auto& term = guide.terms()[i];
    const std::string name = mixture ? fmt::format("{:.3g} x ", term.weight / total) : fmt::format("{}. ", i + 1);
    draw(term.guide, above, name, deeper, i + 1 == guide.terms().size(), out);
  }
}

}  // namespace

std::string GuideSpec::tree() const {
  std::string drawn;
  draw(*this, {}, "", "", true, drawn);
  // The root has no parent, so its branch symbol and the indentation of all lines are removed.
  constexpr std::string_view branch = "└─ ";
  constexpr std::string_view blank = "   ";
  std::string out = drawn.substr(branch.size(), drawn.find('\n') + 1 - branch.size());
  for (std::size_t at = drawn.find('\n') + 1; at < drawn.size();) {
    const std::size_t end = drawn.find('\n', at) + 1;
    out.append(drawn, at + blank.size(), end - at - blank.size());
    at = end;
  }
  return out;
}

StrategySpec::StrategySpec(PlannerSpec planner) : planner_(std::move(planner)) { check_root(planner_); }
StrategySpec::StrategySpec(PlannerSpec planner, GuideSpec guide)
    : planner_(std::move(planner)), guide_(std::move(guide)) {
  check_root(planner_);
}

StrategySpec StrategySpec::with(const std::string& option, const OptionValue& value) const {
  StrategySpec spec = *this;
  spec.planner_ = planner_.with(option, value);
  return spec;
}

std::string StrategySpec::text() const {
  if (!guide_) return planner_.text();
  return in_front(*guide_) + " >> " + planner_.text();
}

std::string StrategySpec::tree() const {
  std::string out = planner_.text() + "\n";
  if (guide_) draw(*guide_, {&planner_}, "", "", true, out);
  return out;
}

std::string StrategySpec::json() const {
  Json json = planner_json(planner_);
  if (guide_) json["guided_by"] = guide_json(*guide_, {&planner_});
  return json.dump();
}

std::uint64_t StrategySpec::hash() const { return stable_hash(json()); }

StrategySpec operator>>(const GuideSpec& above, const StrategySpec& guided) {
  if (guided.guide() != nullptr) return {guided.planner(), above >> *guided.guide()};
  return {guided.planner(), above};
}

StrategySpec operator>>(const GuideSpec& above, const PlannerSpec& planner) { return {planner, above}; }

StrategySpec split(const StrategySpec& part, const SplitSettings& settings) {
  const PlannerSpec planner = split(part.planner(), settings);
  return part.guide() != nullptr ? StrategySpec(planner, *part.guide()) : StrategySpec(planner);
}

}  // namespace trellis
