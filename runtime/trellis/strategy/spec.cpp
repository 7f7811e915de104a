// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/strategy/spec.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include <trellis/base/random.hpp>
#include <trellis/guide/guide.hpp>
#include <trellis/planner/planner.hpp>
#include <trellis/strategy/registry.hpp>

namespace trellis {

namespace {

using Json = nlohmann::ordered_json;

std::string options_text(const Component& component, const Options& options, const std::string& more) {
  // Positional options are what a component is known by: they come first, without their names, and always.
  std::vector<std::string> named;
  std::vector<std::string> unnamed;
  const bool braces = !more.empty();
  for (const auto& [name, value] : options.entries()) {
    const bool changed = !(value == component.find(name)->default_value);
    const auto& positional = component.positional;
    if (std::find(positional.begin(), positional.end(), name) != positional.end()) {
      if (const auto* names = std::get_if<std::vector<std::string>>(&value)) {
        for (const auto& element : *names) unnamed.push_back(to_string(OptionValue(element)));
      } else {
        unnamed.push_back(to_string(value));
      }
    } else if (changed) {
      named.push_back(fmt::format("{} = {}", name, to_string(value)));
    }
  }
  if (braces) named.push_back(more);
  if (named.empty()) return fmt::format("({})", fmt::join(unnamed, ", "));
  for (auto& text : named) unnamed.push_back(std::move(text));
  return fmt::format(" {{ {} }}", fmt::join(unnamed, ", "));
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
  return {{"planner", planner.name()}, {"options", options_json(planner.options())}};
}

/// The options of a blend that differ from their defaults, as a script writes them.
std::vector<std::string> blend_options(const BlendSettings& settings) {
  const BlendSettings plain;
  std::vector<std::string> given;
  if (settings.floor != plain.floor) given.push_back("floor = " + to_string(OptionValue(settings.floor)));
  if (settings.decay != plain.decay) given.push_back("decay = " + to_string(OptionValue(settings.decay)));
  if (settings.credit != plain.credit) given.push_back("credit = " + to_string(OptionValue(settings.credit)));
  return given;
}

Json guide_json(const GuideSpec& guide) {
  if (guide.kind() == GuideSpec::Kind::component) {
    Json json = {{"guide", guide.name()}, {"options", options_json(guide.options())}};
    if (guide.planner()) json["search"] = planner_json(*guide.planner());
    if (guide.below() != nullptr) json["guided_by"] = guide_json(*guide.below());
    return json;
  }
  Json parts = Json::array();
  double total = 0.0;
  for (const auto& term : guide.terms()) total += term.weight;
  for (const auto& term : guide.terms()) {
    if (guide.kind() == GuideSpec::Kind::mixture) {
      parts.push_back({{"weight", term.weight / total}, {"guide", guide_json(term.guide)}});
    } else {
      parts.push_back(guide_json(term.guide));
    }
  }
  if (guide.kind() == GuideSpec::Kind::mixture) return {{"mixture", parts}};
  if (guide.kind() == GuideSpec::Kind::blend) {
    const BlendSettings& blending = guide.blending();
    return {{"blend", parts}, {"floor", blending.floor}, {"decay", blending.decay}, {"credit", blending.credit}};
  }
  return {{"sequence", parts}, {"turn", guide.turn()}};
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

std::string PlannerSpec::text() const {
  return name_ + options_text(component(Component::Kind::planner, name_), options_, "");
}

// ---- guides

struct GuideSpec::Node {
  Kind kind = Kind::component;
  std::string name;
  Options options;
  std::optional<PlannerSpec> planner;
  bool planner_given = false;  ///< only for how it is written
  std::optional<GuideSpec> below;
  Origin origin;
  std::vector<Term> terms;
  std::int64_t turn = default_turn;
  BlendSettings blending;
};

GuideSpec GuideSpec::make(const std::string& name, const std::vector<Options::Entry>& given,
                          std::optional<PlannerSpec> planner, Origin origin) {
  const Component& described = component(Component::Kind::guide, name);
  const GuideKind& kind = *find_guide(name);
  auto node = std::make_shared<Node>();
  node->name = name;
  node->options = Options::validate(described, given);
  node->origin = std::move(origin);
  if (kind.default_planner.empty()) {
    if (planner) throw Error(fmt::format("{}: has no space to search (S = {{0}}), so it takes no planner", name));
    return GuideSpec(std::move(node));
  }
  const bool graph = find_planner(kind.default_planner)->graph;
  if (planner && !kind.graph_optional && find_planner(planner->name())->graph != graph) {
    throw Error(graph ? fmt::format("{}: its space is an explicit graph and is searched exactly; '{}' cannot search it "
                                    "(expected planner = graph_search)",
                                    name, planner->name())
                      : fmt::format("{}: its space is no explicit graph; 'graph_search' cannot search it (expected a "
                                    "sampling planner such as {})",
                                    name, kind.default_planner));
  }
  node->planner_given = planner.has_value();
  node->planner = planner ? std::move(planner) : PlannerSpec::make(kind.default_planner, {});
  return GuideSpec(std::move(node));
}

GuideSpec::Kind GuideSpec::kind() const { return node_->kind; }
const std::string& GuideSpec::name() const { return node_->name; }
const Options& GuideSpec::options() const { return node_->options; }
const std::optional<PlannerSpec>& GuideSpec::planner() const { return node_->planner; }
const GuideSpec* GuideSpec::below() const { return node_->below ? &*node_->below : nullptr; }
const Origin& GuideSpec::origin() const { return node_->origin; }
const std::vector<GuideSpec::Term>& GuideSpec::terms() const { return node_->terms; }
std::int64_t GuideSpec::turn() const { return node_->turn; }
const BlendSettings& GuideSpec::blending() const { return node_->blending; }

bool GuideSpec::searches() const {
  if (kind() == Kind::component) return node_->planner.has_value();
  return std::any_of(terms().begin(), terms().end(), [](const Term& term) { return term.guide.searches(); });
}

std::string GuideSpec::text() const {
  switch (kind()) {
    case Kind::component: {
      const std::string planner = node_->planner_given ? "planner = " + node_->planner->text() : "";
      std::string self =
          node_->name + options_text(component(Component::Kind::guide, node_->name), node_->options, planner);
      if (!node_->below) return self;
      const std::string above = node_->below->text();
      const bool loose = node_->below->kind() == Kind::mixture || node_->below->kind() == Kind::sequence;
      return (loose ? "(" + above + ")" : above) + " >> " + self;
    }
    case Kind::mixture: {
      double total = 0.0;
      for (const auto& term : terms()) total += term.weight;
      std::vector<std::string> parts;
      for (const auto& term : terms()) {
        const bool loose =
            term.guide.kind() != Kind::blend && (term.guide.kind() != Kind::component || term.guide.below() != nullptr);
        const std::string inner = loose ? "(" + term.guide.text() + ")" : term.guide.text();
        parts.push_back(fmt::format("{:.4g}*{}", term.weight / total, inner));
      }
      return fmt::format("{}", fmt::join(parts, " + "));
    }
    case Kind::sequence: {
      std::vector<std::string> parts;
      for (const auto& term : terms()) {
        const bool loose = term.guide.kind() == Kind::mixture ||
                           (term.guide.kind() == Kind::component && term.guide.below() != nullptr);
        parts.push_back(loose ? "(" + term.guide.text() + ")" : term.guide.text());
      }
      if (turn() != default_turn) return fmt::format("sequence {{ {}, turn = {} }}", fmt::join(parts, ", "), turn());
      return fmt::format("{}", fmt::join(parts, " .. "));
    }
    case Kind::blend: {
      std::vector<std::string> parts;
      for (const auto& term : terms()) parts.push_back(term.guide.text());
      for (auto& option : blend_options(blending())) parts.push_back(std::move(option));
      return fmt::format("blend {{ {} }}", fmt::join(parts, ", "));
    }
  }
  throw Fault("unknown kind of guide");
}

bool operator==(const GuideSpec& a, const GuideSpec& b) {
  if (a.node_ == b.node_) return true;
  if (a.kind() != b.kind()) return false;
  if (a.kind() == GuideSpec::Kind::component) {
    if (a.name() != b.name() || !(a.options() == b.options()) || !(a.planner() == b.planner())) return false;
    if ((a.below() == nullptr) != (b.below() == nullptr)) return false;
    return a.below() == nullptr || *a.below() == *b.below();
  }
  if (a.terms().size() != b.terms().size() || a.turn() != b.turn()) return false;
  if (!(a.blending() == b.blending())) return false;
  double total_a = 0.0;
  double total_b = 0.0;
  for (const auto& term : a.terms()) total_a += term.weight;
  for (const auto& term : b.terms()) total_b += term.weight;
  for (std::size_t i = 0; i < a.terms().size(); ++i) {
    // Weights are equal when they are once normalised, up to rounding: 0.5*a + 0.5*b is a + b.
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
  if (guide.kind() == GuideSpec::Kind::mixture) {
    for (const auto& term : guide.terms()) node->terms.push_back({weight * term.weight, term.guide});
  } else {
    node->terms.push_back({weight, guide});
  }
  return GuideSpec(std::move(node));
}

GuideSpec sequence(const std::vector<GuideSpec>& parts, std::int64_t turn) {
  if (parts.empty()) throw Error("sequence: needs at least one guide");
  if (turn < 1) throw Error(fmt::format("sequence: turn must be an integer of at least 1, got {}", turn));
  auto node = std::make_shared<GuideSpec::Node>();
  node->kind = GuideSpec::Kind::sequence;
  node->turn = turn;
  for (const auto& part : parts) {
    if (part.kind() == GuideSpec::Kind::sequence && part.turn() == turn) {
      node->terms.insert(node->terms.end(), part.terms().begin(), part.terms().end());
    } else {
      node->terms.push_back({1.0, part});
    }
  }
  return GuideSpec(std::move(node));
}

const Settings<BlendSettings>& blend_settings() {
  static const auto settings =
      Settings<BlendSettings>(
          Component::Kind::combinator, "blend", "a mixture whose weights follow what each guide's proposals achieved",
          "the rule of Denny, Sandstrom, Bregger and Amato 2016 for regions, with guides in their place; combining "
          "guides: Attali, Ashur, Love, McBeth, Motes, Morales and Amato 2024, arXiv 2404.03133")
          .number("floor", &BlendSettings::floor, "share of proposals", {.lo = 0, .hi = 1, .open_lo = true},
                  "share that is spread evenly over the parts, so that none starves; the rest follows successes over "
                  "attempts; 1: an even mixture")
          .number("decay", &BlendSettings::decay, "factor", {.lo = 0, .hi = 1, .open_lo = true},
                  "what a part's successes and attempts are multiplied by before each new one is counted; 1 / (1 - "
                  "decay) of its proposals are remembered")
          .choice("credit", &BlendSettings::credit, {"node", "reach"},
                  "what a success is: \"node\", 1 for each proposal that led to a node; \"reach\", the length of the "
                  "extension to that node, by the longest of the run so far");
  return settings;
}

GuideSpec blend(const std::vector<GuideSpec>& parts, const BlendSettings& settings) {
  if (parts.empty()) throw Error("blend: needs at least one guide");
  Options::validate(blend_settings().component(),
                    {{"floor", settings.floor}, {"decay", settings.decay}, {"credit", settings.credit}});
  auto node = std::make_shared<GuideSpec::Node>();
  node->kind = GuideSpec::Kind::blend;
  node->blending = settings;
  node->terms.reserve(parts.size());
  for (const auto& part : parts) node->terms.push_back({1.0, part});
  return GuideSpec(std::move(node));
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

void draw(const GuideSpec& guide, const std::string& label, const std::string& indent, bool last, std::string& out) {
  const auto head = [&](const std::string& text) { out += indent + (last ? "└─ " : "├─ ") + label + text + "\n"; };
  const std::string deeper = indent + (last ? "   " : "│  ");
  if (guide.kind() == GuideSpec::Kind::component) {
    const GuideSpec self = GuideSpec::make(guide.name(), guide.options().entries());
    head(self.text() + (guide.planner() ? "  searched by " + guide.planner()->text() : "  S = {0}"));
    if (guide.below() != nullptr) draw(*guide.below(), "", deeper, true, out);
    return;
  }
  const bool mixture = guide.kind() == GuideSpec::Kind::mixture;
  if (guide.kind() == GuideSpec::Kind::blend) {
    const auto& blending = guide.blending();
    head(fmt::format("blend, floor {:.3g}, decay {:.3g}, credit {}", blending.floor, blending.decay, blending.credit));
  } else {
    head(mixture ? "mixture" : fmt::format("sequence, turns of {} proposals", guide.turn()));
  }
  double total = 0.0;
  for (const auto& term : guide.terms()) total += term.weight;
  for (std::size_t i = 0; i < guide.terms().size(); ++i) {
    const auto& term = guide.terms()[i];
    const std::string name = mixture ? fmt::format("{:.3g} x ", term.weight / total) : fmt::format("{}. ", i + 1);
    draw(term.guide, name, deeper, i + 1 == guide.terms().size(), out);
  }
}

}  // namespace

std::string GuideSpec::tree() const {
  std::string drawn;
  draw(*this, "", "", true, drawn);
  // As it hangs below nothing, the branch that would lead to it goes, and its width from every line.
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

std::string StrategySpec::text() const {
  if (!guide_) return planner_.text();
  const std::string guide = guide_->text();
  const bool loose = guide_->kind() == GuideSpec::Kind::mixture || guide_->kind() == GuideSpec::Kind::sequence;
  return (loose ? "(" + guide + ")" : guide) + " >> " + planner_.text();
}

std::string StrategySpec::tree() const {
  std::string out = planner_.text() + "\n";
  if (guide_) draw(*guide_, "", "", true, out);
  return out;
}

std::string StrategySpec::json() const {
  Json json = planner_json(planner_);
  if (guide_) json["guided_by"] = guide_json(*guide_);
  return json.dump();
}

std::uint64_t StrategySpec::hash() const { return stable_hash(json()); }

StrategySpec operator>>(const GuideSpec& above, const StrategySpec& guided) {
  if (guided.guide() != nullptr) return {guided.planner(), above >> *guided.guide()};
  return {guided.planner(), above};
}

StrategySpec operator>>(const GuideSpec& above, const PlannerSpec& planner) { return {planner, above}; }

}  // namespace trellis
