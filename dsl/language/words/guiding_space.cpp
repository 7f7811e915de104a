// SPDX-License-Identifier: GPL-3.0-or-later
// Guides that scripts define. For their functions at run time see script_guide.cpp.
#include <dsl/language/words/guiding_space.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

#include <dsl/language/words/configuration.hpp>
#include <dsl/language/words/instance_value.hpp>
#include <dsl/language/words/known_value.hpp>
#include <dsl/language/words/scene_values.hpp>
#include <dsl/lua/digest.hpp>
#include <dsl/lua/snapshot.hpp>
#include <trellis/base/lua_time.hpp>
#include <trellis/guide/pieces.hpp>

namespace trellis::dsl {

namespace {

using lua::Stack;
using lua::Type;
using lua::Value;

struct GuidingSpaceSettings {
  std::int64_t resolves = PathGuideSettings{}.resolves;
};

const Settings<GuidingSpaceSettings>& guiding_space_settings() {
  static const auto settings =
      Settings<GuidingSpaceSettings>(Component::Kind::combinator, "guiding_space", "a guiding space of one's own",
                                     "Attali et al. 2024, A framework for guided motion planning, arXiv 2404.03133")
          .integer("resolves", &GuidingSpaceSettings::resolves, "re-solves", Range::non_negative(),
                   "how often its space may be solved again");
  return settings;
}

constexpr const char* takes_instance = "fun(instance: trellis.Instance, known: trellis.Known): ";

const Construct& guiding_space_construct() {
  const std::string by_instance = takes_instance;
  static const Construct construct = {
      .name = "guiding_space",
      .usage = "guiding_space { name = \"half\", robot = function(instance) return instance.robot:scaled(0.5) end }",
      .summary = "a guiding space of one's own: f, and h from what the search of S found; see docs/guiding_space.md",
      .list = "",
      .element = "",
      .fields =
          {{"name", "string", "a name as of a variable", "how strategies, reports and messages call it", false,
            "\"guiding_space\""},
           {"space", "string[]|trellis.Space|" + by_instance + "string[]|trellis.Space",
            "a space, a list of names of axes of C, or a function",
            "S: some axes of C by their names, or a space such as instance.space; {} is S = {0}, a bias without a "
            "space; C's own space by default; the same space in each call"},
           {"project", "fun(...: number): number", "a function",
            "f: called with the coordinates of a configuration of C, returns those of one of S; by default S has axes "
            "of C with their names, and f selects them"},
           {"lift", "fun(...: any): number", "a function",
            "draws from the fibre: called with the coordinates of a configuration of S and the functions random and "
            "normal, returns those of one of C that f maps to it; by default the axes that S lacks are uniform; "
            "needed with 'project'"},
           {"valid", R"("free"|"parent"|fun(...: number): boolean)",
            R"(a function, "free" (all of S is valid) or "parent" (as in C))",
            "validity in S; a function is called with the coordinates of every configuration that is checked, "
            "which costs some tenths of a microsecond each: 'robot' and 'world' are checked at full speed"},
           {"robot", "trellis.Robot|" + by_instance + "trellis.Robot", "a robot, or a function that returns one",
            "checked for collisions in S; by default C's; a function with a second parameter is called again, with "
            "what is "
            "known about C, when h is stale and when the guide's turn in a sequence comes; so are those of 'space', "
            "'world' and 'graph'"},
           {"world", "trellis.World|" + by_instance + "trellis.World", "a world, or a function that returns one",
            "that the robot is checked in; by default C's"},
           {"graph",
            by_instance + "{ vertices: number[][], edges: number[][], start: integer, goal: integer|integer[] }",
            "a function",
            "returns an explicit graph in S, searched exactly: edges are {i, j} or {i, j, cost}, straight and as long "
            "as they are by default; 'goal' is a vertex, or a list of vertices any of which will do"},
           {"planner", "trellis.Planner", "a planner", "searches S", false, "rrt(), graph_search() of a graph"},
           {"heuristic", "fun(found?: trellis.Found, instance: trellis.Instance): trellis.Guide|function, function?",
            "a function",
            "h: called each time that S was solved, with the path found and the instance in C; returns a sum of "
            "along(path), ball(q, r), lifted(...) and guides with S = {0}, or a function that draws: called with "
            "random and normal, it returns a configuration of C, perhaps with the node to extend and the control to "
            "extend it under, and its density may follow it; by default along the path found, lifted"},
           {"density", "fun(...: number): number", "a function",
            "of the function that 'heuristic' returned: its density at the coordinates of a configuration of C, with "
            "respect to volume in metric coordinates"},
           {"observe", "fun(outcome: trellis.Outcome): trellis.Guide|function|nil, function?", "a function",
            "receives the outcome of each proposal; may return another h, as 'heuristic' does, which replaces it"},
           {"stale", "fun(): boolean", "a function",
            "whether S is to be solved again before the next proposal; called when h was made, before each proposal "
            "and "
            "after each outcome, so it must change nothing; h made of along(path) asks for that by itself too"},
           {"restart", "fun()", "a function",
            "called when the planner in C removed nodes: 'observe' then receives those that are left as outcomes that "
            "are not mine, and 'heuristic' is called again before the next proposal"}},
      .options = guiding_space_settings().component(),
      .returns = "trellis.Guide"};
  return construct;
}

const Construct& along_construct() {
  static const Construct construct = {
      .name = "along",
      .usage = "along(found.path, { radius = 0.3 })",
      .summary = along_settings().component().summary,
      .list = "",
      .element = "",
      .fields = {},
      .options = along_settings().component(),
      .returns = "trellis.Guide",
      .arguments = {{"path", "number[][]", "a list of configurations",
                     "in order; uniform proposals where there are fewer than two", true}}};
  return construct;
}

const Construct& ball_construct() {
  static const Construct construct = {
      .name = "ball",
      .usage = "ball({5, 5, 0}, 0.5)",
      .summary = "uniform on the ball about a configuration: S = {0}",
      .list = "",
      .element = "",
      .fields = {},
      .options = {},
      .returns = "trellis.Guide",
      .arguments = {{"centre", "number[]", "a configuration", "where the ball is", true},
                    {"radius", "number", "a number greater than 0 (m in the metric)",
                     "shortened where the ball would meet itself", true}}};
  return construct;
}

const Construct& lifted_construct() {
  static const Construct construct = {
      .name = "lifted",
      .usage = "lifted(along(found.path))",
      .summary = "in the heuristic of guiding_space: a distribution over S, each draw lifted to C",
      .list = "",
      .element = "",
      .fields = {},
      .options = {},
      .returns = "trellis.Guide",
      .arguments = {{"distribution", "trellis.Guide", "a sum of along(path), ball(q, r) and guides with S = {0}",
                     "over S", true}}};
  return construct;
}

// Definitions
// ----------------------------------------------------------------------------------------------------------------

std::string shape_text(const ConvexShape& shape) {
  return std::visit(
      [](const auto& s) {
        std::string text;
        if constexpr (requires { s.radius; }) {
          text = fmt::format("disc {} {} {}", s.centre.x, s.centre.y, s.radius);
        } else {
          for (const Vec2& v : s.vertices) text += fmt::format("{} {},", v.x, v.y);
        }
        return text;
      },
      shape);
}

std::string solid_text(const Solid& solid) {
  const auto& [p, q] = solid.pose;
  const std::string shape = std::visit(
      [](const auto& s) {
        using Shape = std::decay_t<decltype(s)>;
        if constexpr (std::is_same_v<Shape, Sphere>) {
          return fmt::format("sphere {}", s.radius);
        } else if constexpr (std::is_same_v<Shape, Cuboid>) {
          return fmt::format("box {} {} {}", s.size.x, s.size.y, s.size.z);
        } else if constexpr (std::is_same_v<Shape, Capsule> || std::is_same_v<Shape, Cylinder>) {
          return fmt::format("{} {} {}", std::is_same_v<Shape, Capsule> ? "capsule" : "cylinder", s.radius, s.length);
        } else if constexpr (std::is_same_v<Shape, std::shared_ptr<const PointCloud>>) {
          return fmt::format("points {:016x}", s->hash());
        } else {
          return fmt::format("mesh {:016x}", s->hash());
        }
      },
      solid.shape);
  return fmt::format("{} at {} {} {} {} {} {} {};", shape, p.x, p.y, p.z, q.x, q.y, q.z, q.w);
}

std::string shape_text(const NamedShape& named) {
  if (const auto* solid = std::get_if<Solid>(&named.shape)) return named.name + ": " + solid_text(*solid);
  const auto& shape = std::get<Shape>(named.shape);
  const auto* box = std::get_if<Box2>(&shape);
  const auto* disc = std::get_if<Disc>(&shape);
  return named.name + ": " +
         (box != nullptr    ? "box " + shape_text(Polygon{rectangle_vertices(*box)})
          : disc != nullptr ? shape_text(*disc)
                            : shape_text(std::get<Polygon>(shape)));
}

/// Returns the text that identifies an object in a digest.
std::string object_text(Value value) {
  std::string text;
  if (const auto* robot = value.get<Robot>()) {
    for (const Body& body : robot->bodies()) {
      text += fmt::format("body {} {} {} {}:", body.parent, body.joint.x, body.joint.y, body.angle_axis);
      for (const auto& part : body.parts) text += shape_text(part) + ";";
    }
  } else if (const auto* world = value.get<World>()) {
    const auto& [lo, hi] = world->bounds();
    text = fmt::format("world {} {} {} {}:", lo.x, lo.y, hi.x, hi.y);
    for (const auto& part : world->parts()) text += shape_text(part.shape) + ";";
  } else if (const auto* body = value.get<Robot3>()) {
    text = body->rotates() ? "body:" : "body that keeps its orientation:";
    for (const Solid& solid : body->solids()) text += solid_text(solid);
  } else if (const auto* space = value.get<World3>()) {
    const auto& [lo, hi] = space->bounds();
    text = fmt::format("world {} {} {} {} {} {} {} {}:", lo.x, lo.y, lo.z, hi.x, hi.y, hi.z,
                       static_cast<int>(space->contain()), space->surface());
    for (const auto& obstacle : space->obstacles()) text += solid_text(obstacle.solid);
  } else if (const auto* shape = value.get<NamedShape>()) {
    text = shape_text(*shape);
  } else if (const auto* guide = value.get<GuideSpec>()) {
    text = guide->text();
  } else if (value.type() == Type::object) {
    text = describe(value);
  } else {
    text = "value";
  }
  return text;
}

Origin origin_of(const Stack& call) {
  const auto position = call.where();
  return position ? Origin{position->script, position->line} : Origin{};
}

bool is_name(const std::string& name) {
  constexpr std::size_t longest = 60;
  const auto letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  return !name.empty() && name.size() <= longest && letter(name.front()) &&
         std::all_of(name.begin(), name.end(),
                     [&](char c) { return letter(c) || std::isdigit(static_cast<unsigned char>(c)) != 0; });
}

/// Whether an entry may have this value.
bool fits(Slot slot, Value value) {
  if (value.type() == Type::function) return true;
  switch (slot) {
    case Slot::space: return value.type() == Type::table;
    case Slot::valid: return value.string() == "free" || value.string() == "parent";
    case Slot::robot: return robot_in(value).has_value();
    case Slot::world: return world_in(value).has_value();
    default: return false;
  }
}

/// Whether an entry is a function of the instance that has a second parameter: what is known about C.
bool takes_known(Stack& call, Slot slot, Value value) {
  if (slot != Slot::space && slot != Slot::robot && slot != Slot::world && slot != Slot::graph) return false;
  const auto definition = call.definition(value);
  return definition && (definition->parameters > 1 || definition->variadic);
}

/// Rejects entries that contradict each other, or require another one.
void check_together(const GuideDefinition& definition) {
  const auto given = [&](Slot slot) { return definition[slot] != nullptr; };
  const auto fail = [&](const std::string& fault) -> void {
    throw Error(fmt::format("guiding_space: '{}': {}", definition.name, fault));
  };
  if (definition.spaceless) {
    for (const Slot slot : {Slot::project, Slot::lift, Slot::valid, Slot::robot, Slot::world, Slot::graph}) {
      if (given(slot)) fail(fmt::format("S = {{0}} (space = {{}}) has no '{}'", slot_name(slot)));
    }
    if (!given(Slot::heuristic)) fail("S = {0} (space = {}) needs a 'heuristic': there is no path to go along");
  }
  if (given(Slot::project) && !given(Slot::lift)) {
    fail("'project' is given, so 'lift' must say how to draw from the fibre of a configuration of S");
  }
  if (given(Slot::valid) && (given(Slot::robot) || given(Slot::world))) {
    fail("'valid' says what is valid in S already; leave out 'robot' and 'world'");
  }
  if (given(Slot::density) && !given(Slot::heuristic)) {
    fail("'density' is that of a function that 'heuristic' returns, and there is no 'heuristic'");
  }
}

/// Returns the claims of a definition about its f and h.
GuideClaims claims_of(const GuideDefinition& definition) {
  const auto given = [&](Slot slot) { return definition[slot] != nullptr; };
  const auto function = [&](Slot slot) { return fmt::format("the script's function '{}'", slot_name(slot)); };
  GuideClaims claims =
      path_claims(GuideClaims::Category::combinator, "", "S has no path, where S finds them invalid", "");
  if (definition.spaceless) {
    claims.f = "S = {0}";
    claims.fallback = GuideClaims::Fallback::none;
    claims.invalid_ends = "nothing is projected";
    claims.no_path = "nothing is searched";
  } else {
    claims.f = given(Slot::project) ? "q -> project(q), a function of the script"
               : given(Slot::space) ? "q -> its coordinates on the axes of S"
                                    : "q -> q";
    if (given(Slot::robot)) claims.f += "; the script makes the robot that S checks";
    if (given(Slot::world)) claims.f += "; the script makes the world that S checks";
    if (definition.validity == "free") claims.f += "; all of S is valid";
    if (definition.validity == "parent") claims.f += "; valid in S is what C finds valid";
    if (given(Slot::valid) && definition.validity.empty()) claims.f += "; valid in S is what 'valid' says";
    if (given(Slot::graph)) claims.f += "; S is the explicit graph that 'graph' returns";
  }
  if (given(Slot::heuristic)) {
    claims.h = function(Slot::heuristic);
    claims.closed_form = given(Slot::density);
    claims.density = claims.closed_form ? function(Slot::density)
                                        : "of a function that draws; a sum of along(path), ball(q, r) and guides with "
                                          "S = {0} has one";
    claims.fallback = GuideClaims::Fallback::own;
    claims.no_path = "'heuristic' decides";
    claims.feedback = "what 'heuristic' returned continues along its paths";
  }
  if (given(Slot::observe)) claims.feedback = function(Slot::observe) + " receives each outcome";
  if (given(Slot::stale)) claims.feedback += "; 'stale' decides when S is solved again";
  if (definition.uses_known()) claims.feedback += "; f is applied again to what is known about C";
  return claims;
}

/// The guide as a spec: it creates a new guide in each run.
class ScriptGuideSpec final : public CustomGuide {
 public:
  ScriptGuideSpec(Description description, std::shared_ptr<const GuideDefinition> definition,
                  const std::shared_ptr<GuideBook>& book, std::shared_ptr<CalledSlots> called)
      : CustomGuide(std::move(description)),
        identity_(definition->identity),
        called_(std::move(called)),
        reload_(book->reload),
        number_(book->definitions.size() - book->first) {
    if (!reload_) {
      definition_ = std::move(definition);
      book_ = book;
    }
  }

  [[nodiscard]] std::unique_ptr<Guide> make(const GuideSite& site) const override {
    if (!reload_) {
      const auto run =
          std::make_shared<RunInterpreter>(RunInterpreter{definition_->table->interpreter(), book_, book_->mutex});
      if (!run->state) throw Error("the session that it was written in is over");
      return make_script_guide(run, definition_, called_, site);
    }
    const auto run = site.shared.get<RunInterpreter>(reload_.get(), [this] { return reload_->interpreter(); });
    const auto& definitions = run->book->definitions;
    if (number_ >= definitions.size() || definitions[number_]->identity != identity_) {
      throw Error(fmt::format(
          "the script does not define the same guides each time it is loaded: guide {} was {}, and is {}; what it "
          "defines must depend on nothing outside of it, nor on the order in which pairs visits a table",
          number_ + 1, identity_, number_ < definitions.size() ? definitions[number_]->identity : "missing"));
    }
    return make_script_guide(run, definitions[number_], called_, site);
  }

 private:
  std::string identity_;
  std::shared_ptr<CalledSlots> called_;
  std::shared_ptr<const Reload> reload_;
  std::size_t number_;  ///< index of the definition among those of the script
  // Without a script that can be loaded again:
  std::shared_ptr<const GuideDefinition> definition_;
  std::shared_ptr<const GuideBook> book_;
};

int make_guiding_space(Stack& call, const std::shared_ptr<GuideBook>& book) {
  if (call.count() != 1 || call[1].type() != Type::table) {
    throw Error(fmt::format("guiding_space: takes one table, as in {}", guiding_space_construct().usage));
  }
  const Arguments arguments(guiding_space_construct(), call);
  const auto definition = std::make_shared<GuideDefinition>();
  definition->name = arguments.string("name").value_or("guiding_space");
  if (!is_name(definition->name)) arguments.reject("name");
  definition->origin = origin_of(call);
  definition->table = std::make_shared<const lua::Reference>(call, call[1]);
  std::string content;
  for (std::size_t i = 0; i < slots; ++i) {
    const auto slot = static_cast<Slot>(i);
    const Value value = arguments[std::string(slot_name(slot))];
    if (!value.given()) continue;
    if (!fits(slot, value)) arguments.reject(std::string(slot_name(slot)));
    definition->types[i] = value.type();
    definition->values[i] = std::make_shared<const lua::Reference>(call, value);
    const auto function = call.definition(value);
    definition->parameters[i] = function && !function->variadic ? function->parameters : most_parameters;
    definition->known[i] = takes_known(call, slot, value);
    if (slot == Slot::valid) definition->validity = value.string().value_or("");
    if (slot == Slot::space && value.type() == Type::table) {
      const lua::Keys keys = value.keys();
      definition->spaceless = keys.length == 0 && keys.names.empty() && keys.odd.empty();
    }
    content += fmt::format("{} {:016x};", slot_name(slot), lua::digest(value, object_text));
  }
  check_together(*definition);
  const GuidingSpaceSettings settings = guiding_space_settings().read(arguments.options());
  content += fmt::format("resolves {}", settings.resolves);
  definition->identity = fmt::format("{} ({}:{}, {:016x})", definition->name,
                                     std::filesystem::path(definition->origin.script).filename().string(),
                                     definition->origin.line, stable_hash(content));

  const bool graph = (*definition)[Slot::graph] != nullptr;
  CustomGuide::Description description{definition->name, definition->identity,
                                       definition->spaceless ? ""
                                       : graph               ? "graph_search"
                                                             : "rrt",
                                       settings.resolves, claims_of(*definition)};
  std::optional<PlannerSpec> planner;
  if (const Value value = arguments["planner"]; value.given()) {
    if (value.get<PlannerSpec>() == nullptr) arguments.reject("planner");
    planner = *value.get<PlannerSpec>();
  }
  const auto called = std::make_shared<CalledSlots>();
  GuideSpec guide = GuideSpec::make(std::make_shared<ScriptGuideSpec>(std::move(description), definition, book, called),
                                    std::move(planner), definition->origin);
  book->definitions.push_back(definition);
  for (std::size_t i = 0; i < slots; ++i) {
    if (definition->types[i] != Type::function) continue;
    book->given->push_back(
        {fmt::format("{}:{}: ", definition->origin.script, definition->origin.line),
         fmt::format("'{}' of the guiding space '{}'", slot_name(static_cast<Slot>(i)), definition->name),
         [called, i] { return called->flags[i].load(); }, true});
  }
  return call.result(std::move(guide));
}

// Distributions
// ----------------------------------------------------------------------------------------------------------------

int make_along(Stack& call) {
  const Value list = call[1];
  if (list.type() != Type::table) {
    throw Error(
        fmt::format("along: its first argument must be a path, a list of configurations, got {}", describe(list)));
  }
  const Component& component = along_settings().component();
  const Options options = validated(component, read_options(component, call, 2, false).options);
  const lua::Keys keys = list.keys();
  if (!keys.names.empty() || !keys.odd.empty()) {
    throw Error(fmt::format("along: a path is a list of configurations, got a table with {}",
                            keys.names.empty() ? keys.odd : "the field '" + keys.names.front() + "'"));
  }
  Configurations path;
  list.each([&](std::size_t i, Value value) {
    const std::vector<double> q = read_numbers(value, fmt::format("along: point {} of the path", i));
    if (path.empty()) path = Configurations(q.size());
    if (q.empty() || q.size() != path.dimension()) {
      throw Error(fmt::format("along: point {} of the path has {} coordinates, and the first has {}", i, q.size(),
                              path.dimension()));
    }
    path.push(q);
  });
  return call.result(GuideSpec::make(along(std::move(path), options), {}, origin_of(call)));
}

int make_ball(Stack& call) {
  std::vector<double> centre = read_numbers(call[1], "ball: its centre");
  const auto radius = call[2].number();
  if (!radius || !(*radius > 0.0) || !std::isfinite(*radius)) {
    throw Error(
        fmt::format("ball: its radius must be a number greater than 0 (m in the metric), got {}", describe(call[2])));
  }
  if (centre.empty()) throw Error("ball: its centre must be a configuration, got an empty list");
  return call.result(GuideSpec::make(ball(std::move(centre), *radius), {}, origin_of(call)));
}

int make_lifted(Stack& call) {
  const auto* distribution = call[1].get<GuideSpec>();
  if (distribution == nullptr) {
    throw Error(fmt::format("lifted: takes a distribution over S, as along(found.path), got {}", describe(call[1])));
  }
  return call.result(GuideSpec::make(std::make_shared<Lifted>(*distribution), {}, origin_of(call)));
}

std::string identity_of(const GuideSpec& distribution) {
  if (distribution.kind() == GuideSpec::Kind::component && distribution.custom()) {
    return distribution.custom()->description().identity;
  }
  std::string text = distribution.text();
  if (distribution.kind() != GuideSpec::Kind::component) {
    for (const auto& term : distribution.terms()) text += "; " + identity_of(term.guide);
  }
  return text;
}

}  // namespace

/// An interpreter that has loaded the script, and its state after that.
struct Reload::Loaded {
  explicit Loaded(std::shared_ptr<RunInterpreter> interpreter) : run(std::move(interpreter)) {
    std::vector<const lua::Reference*> roots;
    for (const auto& definition : run->book->definitions) roots.push_back(definition->table.get());
    for (const auto& definition : run->book->definitions) {
      for (const auto& value : definition->values) {
        if (value) roots.push_back(value.get());
      }
    }
    run->state->run([&](Stack& stack) { state.emplace(stack, roots); });
    made = counts();
  }
  Loaded(const Loaded&) = delete;
  Loaded& operator=(const Loaded&) = delete;
  ~Loaded() = default;

  /// What functions of the language add to when they are called.
  [[nodiscard]] std::array<std::size_t, 3> counts() const {
    return {run->book->definitions.size(), run->book->given->size(), run->book->warnings->size()};
  }
  [[nodiscard]] bool unchanged() const {
    if (run->failed || counts() != made) return false;
    bool same = false;
    run->state->run([&](Stack& stack) { same = state->unchanged(stack); });
    return same;
  }

  std::shared_ptr<RunInterpreter> run;
  std::optional<lua::Snapshot> state;
  std::array<std::size_t, 3> made{};
};

Reload::Reload(std::function<std::shared_ptr<RunInterpreter>()> load, bool reuse)
    : load_(std::move(load)), reuse_(reuse) {}

Reload::~Reload() = default;

std::shared_ptr<RunInterpreter> Reload::interpreter() const {
  std::shared_ptr<Loaded> loaded;
  {
    const std::scoped_lock lock(mutex_);
    if (!idle_.empty()) {
      loaded = std::move(idle_.back());
      idle_.pop_back();
    }
  }
  if (!loaded) {
    const LuaTimer timer;
    auto run = load_();
    if (!reuse_) return run;
    loaded = std::make_shared<Loaded>(std::move(run));
  }
  RunInterpreter* run = loaded->run.get();
  const auto back = [self = shared_from_this(), loaded = std::move(loaded)](RunInterpreter*) mutable {
    self->take_back(std::move(loaded));
  };
  return {run, back};
}

void Reload::take_back(std::shared_ptr<Loaded> loaded) const {
  try {
    if (!loaded->unchanged()) return;
    const std::scoped_lock lock(mutex_);
    idle_.push_back(std::move(loaded));
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): the next run loads the script
  }
}

std::string_view slot_name(Slot slot) {
  constexpr std::array<std::string_view, slots> names = {"space",   "project", "lift",  "valid",
                                                         "robot",   "world",   "graph", "heuristic",
                                                         "density", "observe", "stale", "restart"};
  return names[static_cast<std::size_t>(slot)];
}

Lifted::Lifted(GuideSpec distribution)
    : CustomGuide({.name = fmt::format("lifted({})", distribution.text()),
                   .identity = fmt::format("lifted {}", identity_of(distribution)),
                   .default_planner = ""}),
      distribution_(std::move(distribution)) {}

std::unique_ptr<Guide> Lifted::make(const GuideSite&) const {
  throw Error("only the heuristic of a guiding_space may return what is lifted: it alone has a space to lift from");
}

std::vector<const Construct*> guiding_space_constructs() {
  return {&guiding_space_construct(), &along_construct(), &ball_construct(), &lifted_construct()};
}

std::vector<ObjectType> guiding_space_types() {
  const std::string configuration = "number[]";
  std::vector<ObjectType> types = instance_types();
  for (ObjectType& type : known_types()) types.push_back(std::move(type));
  types.push_back({"trellis.Found", "what the search of S found", "", {}, {}});
  types.back().members = {
      {"solved", "boolean", "", "whether it found a path"},
      {"status", "string", "", "how it ended, as reports have it"},
      {"path", "number[][]", "",
       "configurations of S from the start to the goal, or to what came nearest; empty where there is none"}};
  types.push_back({"trellis.Outcome", "what became of a proposal; the same table each time", "", {}, {}});
  types.back().members = {{"fate", "string", "", R"("reached", "advanced" (a node towards it) or "rejected")"},
                          {"mine", "boolean", "", "whether this h drew it"},
                          {"proposal", configuration, "", "what was proposed, in C"},
                          {"near", configuration + "?", "", "the node that the extension started from"},
                          {"added", configuration + "?", "", "the node that was added"},
                          {"number", "integer?", "",
                           "the number of the node `added`; a function that draws may return it after the coordinates, "
                           "as the node to extend"},
                          {"near_number", "integer?", "", "the number of the node `near`"},
                          {"control", "number[]?", "",
                           "the control that `near` was driven under; nil without a motion model and on a curve"},
                          {"duration", "number?", "", "seconds for which the motion under `control` is valid"},
                          {"blocked_at", configuration + "?", "", "the first configuration that was found invalid"}};
  return types;
}

void open_guiding_space(Stack& stack, const std::shared_ptr<GuideBook>& book) {
  open_instance(stack);
  open_known(stack);
  stack.push_function([book](Stack& call) { return make_guiding_space(call, book); });
  stack.set_global(guiding_space_construct().name);
  for (const auto& [construct, make] : std::vector<std::pair<const Construct*, int (*)(Stack&)>>{
           {&along_construct(), make_along}, {&ball_construct(), make_ball}, {&lifted_construct(), make_lifted}}) {
    stack.push_function(make);
    stack.set_global(construct->name);
  }
}

}  // namespace trellis::dsl
