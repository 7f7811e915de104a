// SPDX-License-Identifier: MIT-0
// The words of the language as values of Python; python/trellis/_language.py makes functions of them. Words run in one
// interpreter of the process. Strategies, guides, problems and experiments leave it as values of C++; of all else, as
// worlds and robots, Python has a reference.
#include "language.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include <dsl/language/core/construct.hpp>
#include <dsl/language/core/stdlib.hpp>
#include <dsl/language/tools/help_text.hpp>
#include <dsl/language/tools/reference.hpp>
#include <dsl/language/tools/session.hpp>
#include <dsl/language/tools/vocabulary.hpp>
#include <dsl/language/tools/words.hpp>
#include <dsl/lua/state.hpp>
#include <trellis/base/error.hpp>
#include <trellis/base/errors.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/pictures/scenery.hpp>

#include "call.hpp"

namespace py = pybind11;

using trellis::Error;
using trellis::GuideSpec;
using trellis::PlannerSpec;
using trellis::Problem;
using trellis::StrategySpec;
namespace dsl = trellis::dsl;
namespace lua = trellis::lua;

namespace {

/// Lists within lists are read down to this depth.
constexpr int deepest = 32;

struct Node;

/// The call of a word that made a value, so that another process can repeat it.
struct Recipe {
  std::string word;
  std::vector<Node> arguments;
};

/// A value that stays in the interpreter.
class StoredValue {
 public:
  StoredValue(const lua::Stack& stack, lua::Value value, std::string kind)
      : reference_(std::make_unique<lua::Reference>(stack, value)), kind_(std::move(kind)) {}
  ~StoredValue();
  StoredValue(const StoredValue&) = delete;
  StoredValue& operator=(const StoredValue&) = delete;

  void push(lua::Stack& stack) const { reference_->push(stack); }
  /// As messages name it: "a world".
  [[nodiscard]] const std::string& kind() const { return kind_; }

  std::shared_ptr<const Recipe> recipe;  ///< nullptr: it was made otherwise

 private:
  std::unique_ptr<lua::Reference> reference_;
  std::string kind_;
};

/// A word that is passed itself, as `shrink` in schedule(shrink, scale=[0.3, 0.6]).
struct WordName {
  std::string name;
};

/// A value between Python and the interpreter. It needs no GIL.
struct Node {
  using List = std::vector<Node>;
  using Fields = std::vector<std::pair<std::variant<std::int64_t, std::string>, Node>>;

  std::variant<std::monostate, bool, std::int64_t, double, std::string, GuideSpec, StrategySpec, Problem, dsl::Program,
               WordName, std::shared_ptr<StoredValue>, List, Fields>
      value;
};

bool is_word(std::string_view name) {
  return std::any_of(dsl::words().begin(), dsl::words().end(),
                     [&](const dsl::Word& word) { return word.name == name; });
}

/// The position of the brace that closes the one at `open`; npos: none does.
std::size_t closing_brace(std::string_view text, std::size_t open) {
  int depth = 0;
  for (std::size_t i = open; i < text.size(); ++i) {
    if (text[i] == '{') ++depth;
    if (text[i] == '}' && --depth == 0) return i;
  }
  return std::string_view::npos;
}

/// A message of the language with its calls as Python writes them: rrt { step = 0.5 } is rrt(step=0.5).
/// \param inside  of a call, where braces are lists
std::string in_python(std::string_view text, bool inside = false) {
  constexpr std::string_view assigned = " = ";
  std::string written;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (inside && text.substr(i).starts_with(assigned)) {
      written += '=';
      i += assigned.size() - 1;
      continue;
    }
    const std::size_t end = text[i] == '{' ? closing_brace(text, i) : std::string_view::npos;
    if (end == std::string_view::npos) {
      written += text[i];
      continue;
    }
    const std::size_t stop = written.ends_with(' ') ? written.size() - 1 : written.size();
    std::size_t begin = stop;
    const auto in_name = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.';
    };
    while (begin > 0 && in_name(written[begin - 1])) --begin;
    const bool call = is_word(std::string_view(written).substr(begin, stop - begin));
    if (!call && !inside) {
      written += text[i];
      continue;
    }
    std::string_view content = text.substr(i + 1, end - i - 1);
    while (content.starts_with(' ')) content.remove_prefix(1);
    while (content.ends_with(' ')) content.remove_suffix(1);
    if (call) written.resize(stop);
    const bool fields = !call && content.find(assigned) != std::string_view::npos;
    written += call ? "(" : fields ? "dict(" : "[";
    written += in_python(content, true);
    written += call || fields ? ")" : "]";
    i = end;
  }
  return written;
}

/// The interpreter of the process. Threads use it one after the other.
class Language {
 public:
  /// It is never destroyed: values of Python outlive the module.
  static Language& one() {
    static auto* const made = new Language;
    return *made;
  }

  void set_place(LanguagePlace place) { place_ = std::move(place); }
  [[nodiscard]] const LanguagePlace& place() const { return place_; }

  /// How long a call may take.
  enum class Pace { quick, slow };

  /// Calls what `push` pushes with the arguments, and returns the results. Ctrl-C ends a slow call at any time, a quick
  /// one has no thread of its own.
  /// \param frame  of Python that warnings are about: 1 is the innermost
  py::object call(const std::function<void(lua::Stack&)>& push, const std::vector<Node>& arguments, Pace pace,
                  int frame = 1) {
    std::vector<Node> results;
    std::vector<std::string> warnings;
    std::string printed;
    const auto body = [&] {
      const std::scoped_lock lock(mutex_);
      drop_discarded();
      printed_.clear();
      dsl::Session& session = opened();
      static_cast<void>(session.take_warnings());  // of a call that failed
      session.within_limits([&](lua::Stack& stack) {
        push(stack);
        const int before = stack.size() - 1;
        for (const Node& argument : arguments) push_node(stack, argument);
        stack.call(static_cast<int>(arguments.size()));
        for (int i = before + 1; i <= stack.size(); ++i) results.push_back(read(stack, stack[i], 0));
      });
      warnings = session.take_warnings();
      printed = printed_;
    };
    try {
      if (pace == Pace::slow) {
        place_.interruptibly(body);
      } else {
        const Call running;
        const py::gil_scoped_release released;
        body();
      }
    } catch (const Error& error) {
      throw Error(in_python(error.what()));
    }
    if (!printed.empty()) py::print(printed, py::arg("end") = "");
    for (const std::string& warning : warnings) {
      if (PyErr_WarnEx(PyExc_UserWarning, in_python(warning).c_str(), frame) != 0) throw py::error_already_set();
    }
    if (results.empty()) return py::none();
    if (results.size() == 1) return object_of(results.front());
    py::tuple all(results.size());
    for (std::size_t i = 0; i < results.size(); ++i) all[i] = object_of(results[i]);
    return all;
  }

  /// Called with the GIL or without it, perhaps while another thread uses the interpreter.
  void discard(std::unique_ptr<lua::Reference> reference) {
    const std::scoped_lock lock(discarding_);
    discarded_.push_back(std::move(reference));
  }

  [[nodiscard]] py::object object_of(const Node& node) const;

 private:
  dsl::Session& opened() {
    if (session_) return *session_;
    dsl::SessionOptions options;
    options.trust = true;  // what calls the words is a program in Python, which reaches all files anyway
    options.interrupted = place_.stopped;
    options.print = [this](const std::string& text) { printed_ += text; };
    session_ = std::make_unique<dsl::Session>(".", options);
    return *session_;
  }
  void drop_discarded() {
    std::vector<std::unique_ptr<lua::Reference>> now;
    const std::scoped_lock lock(discarding_);
    now.swap(discarded_);
  }

  static void push_node(lua::Stack& stack, const Node& node);
  static Node read(lua::Stack& stack, lua::Value value, int depth);
  static Node read_table(lua::Stack& stack, lua::Value table, int depth);

  LanguagePlace place_;
  std::mutex mutex_;
  std::unique_ptr<dsl::Session> session_;  ///< guarded by the mutex, as what follows
  std::string printed_;
  std::mutex discarding_;
  std::vector<std::unique_ptr<lua::Reference>> discarded_;  ///< guarded by `discarding_`
};

StoredValue::~StoredValue() { Language::one().discard(std::move(reference_)); }

void push_text(lua::Stack& stack, const std::string& text) { stack.load(text, "=python"); }

void push_word(lua::Stack& stack, const std::string& name) {
  push_text(stack, "return " + name);
  stack.call(0);
}

void Language::push_node(lua::Stack& stack, const Node& node) {
  struct Push {
    lua::Stack& stack;
    void operator()(std::monostate) const { stack.push_nil(); }
    void operator()(bool value) const { stack.push(value); }
    void operator()(std::int64_t value) const { stack.push(value); }
    void operator()(double value) const { stack.push(value); }
    void operator()(const std::string& value) const { stack.push(value); }
    void operator()(const GuideSpec& value) const { stack.push_object(value); }
    void operator()(const StrategySpec& value) const {
      if (value.guide() == nullptr) {
        stack.push_object(value.planner());
      } else {
        stack.push_object(value);
      }
    }
    void operator()(const Problem& value) const { stack.push_object(value); }
    void operator()(const dsl::Program& value) const { stack.push_object(value); }
    void operator()(const WordName& value) const { push_word(stack, value.name); }
    void operator()(const std::shared_ptr<StoredValue>& value) const { value->push(stack); }
    void operator()(const Node::List& list) const {
      const lua::Value table = stack.push_table();
      for (const Node& element : list) {
        push_node(stack, element);
        stack.append(table);
      }
    }
    void operator()(const Node::Fields& fields) const {
      const lua::Value table = stack.push_table();
      for (const auto& [key, value] : fields) {
        push_node(stack, value);
        if (const auto* name = std::get_if<std::string>(&key)) {
          stack.set_field(table, *name);
        } else {
          stack.set_index(table, static_cast<std::size_t>(std::get<std::int64_t>(key)));
        }
      }
    }
  };
  std::visit(Push{stack}, node.value);
}

Node Language::read(lua::Stack& stack, lua::Value value, int depth) {
  if (!value.given()) return {};
  if (const auto boolean = value.boolean()) return {*boolean};
  if (value.is_integer()) return {*value.integer()};
  if (const auto number = value.number()) return {*number};
  if (auto text = value.string()) return {std::move(*text)};
  if (const auto* guide = value.get<GuideSpec>()) return {*guide};
  if (const auto* planner = value.get<PlannerSpec>()) {
    try {
      return {StrategySpec(*planner)};
    } catch (const Error&) {  // of explicit graphs
      return {std::make_shared<StoredValue>(stack, value, value.describe())};
    }
  }
  if (const auto* strategy = value.get<StrategySpec>()) return {*strategy};
  if (const auto* problem = value.get<Problem>()) return {*problem};
  if (const auto* program = value.get<dsl::Program>()) return {*program};
  if (value.type() == lua::Type::table && depth < deepest) return read_table(stack, value, depth);
  return {std::make_shared<StoredValue>(stack, value, value.describe())};
}

Node Language::read_table(lua::Stack& stack, lua::Value table, int depth) {
  const lua::Keys keys = table.keys();
  if (!keys.odd.empty()) return {std::make_shared<StoredValue>(stack, table, table.describe())};
  Node::List list;
  table.each([&](std::size_t, lua::Value element) { list.push_back(read(stack, element, depth + 1)); });
  if (keys.names.empty()) return {std::move(list)};
  Node::Fields fields;
  for (std::size_t i = 0; i < list.size(); ++i)
    fields.emplace_back(static_cast<std::int64_t>(i + 1), std::move(list[i]));
  for (const std::string& name : keys.names) fields.emplace_back(name, read(stack, table.field(name), depth + 1));
  return {std::move(fields)};
}

// Python
// --------------------------------------------------------------------------------------------------------------------

/// A reference to a value, as Python holds it.
struct ValueObject {
  std::shared_ptr<StoredValue> held;
};

py::object Language::object_of(const Node& node) const {
  struct Make {
    const Language& language;
    py::object operator()(std::monostate) const { return py::none(); }
    py::object operator()(bool value) const { return py::bool_(value); }
    py::object operator()(std::int64_t value) const { return py::int_(value); }
    py::object operator()(double value) const { return py::float_(value); }
    py::object operator()(const std::string& value) const { return py::str(value); }
    py::object operator()(const GuideSpec& value) const { return py::cast(value); }
    py::object operator()(const StrategySpec& value) const { return py::cast(value); }
    py::object operator()(const Problem& value) const { return language.place_.problem(value); }
    py::object operator()(const dsl::Program& value) const { return language.place_.experiment(value); }
    py::object operator()(const WordName& value) const { return py::str(value.name); }
    py::object operator()(const std::shared_ptr<StoredValue>& value) const { return py::cast(ValueObject{value}); }
    py::object operator()(const Node::List& list) const {
      py::list all;
      for (const Node& element : list) all.append(language.object_of(element));
      return all;
    }
    py::object operator()(const Node::Fields& fields) const {
      py::dict all;
      for (const auto& [key, value] : fields) {
        const auto* name = std::get_if<std::string>(&key);
        all[name != nullptr ? py::object(py::str(*name)) : py::object(py::int_(std::get<std::int64_t>(key)))] =
            language.object_of(value);
      }
      return all;
    }
  };
  return std::visit(Make{*this}, node.value);
}

std::string text_of(py::handle object) {
  constexpr std::size_t longest = 80;
  std::string text = py::repr(object).cast<std::string>();
  if (text.size() > longest) text = text.substr(0, longest) + "...";
  return text;
}

Node read_int(py::handle object, const std::string& what) {
  int overflow = 0;
  const long long value = PyLong_AsLongLongAndOverflow(object.ptr(), &overflow);
  if (value == -1 && PyErr_Occurred() != nullptr) throw py::error_already_set();
  if (overflow != 0) throw Error(what + ": the integer " + text_of(object) + " does not fit in 64 bits");
  return {std::int64_t{value}};
}

bool has(py::handle object, const char* name) { return py::hasattr(object, name); }

/// \param what  names the argument in messages: "rrt: step"
Node node_of(py::handle object, const std::string& what, int depth = 0);

Node list_of(py::handle list, const std::string& what, int depth) {
  Node::List elements;
  std::size_t number = 0;
  for (const py::handle element : list) {
    ++number;
    elements.push_back(node_of(element, what, depth + 1));
    if (std::holds_alternative<std::monostate>(elements.back().value)) {
      throw Error(what + ": a list cannot hold None, which is its element " + std::to_string(number));
    }
  }
  return {std::move(elements)};
}

Node fields_of(py::handle mapping, const std::string& what, int depth) {
  Node::Fields fields;
  for (const py::handle item : mapping.attr("items")()) {
    const auto pair = py::reinterpret_borrow<py::tuple>(item);
    const py::object key = pair[0];
    Node value = node_of(pair[1], what, depth + 1);
    if (py::isinstance<py::str>(key)) {
      fields.emplace_back(key.cast<std::string>(), std::move(value));
    } else if (PyLong_Check(key.ptr()) != 0 && PyBool_Check(key.ptr()) == 0 && key.cast<std::int64_t>() > 0) {
      fields.emplace_back(key.cast<std::int64_t>(), std::move(value));
    } else {
      throw Error(what + ": the keys of a dict are names, got " + text_of(key));
    }
  }
  return {std::move(fields)};
}

Node node_of(py::handle object, const std::string& what, int depth) {
  if (depth > deepest) throw Error(what + ": lists stand within lists more than " + std::to_string(deepest) + " deep");
  PyObject* const raw = object.ptr();
  if (object.is_none()) return {};
  if (PyBool_Check(raw) != 0) return {raw == Py_True};
  if (PyLong_Check(raw) != 0) return read_int(object, what);
  if (PyFloat_Check(raw) != 0) return {PyFloat_AS_DOUBLE(raw)};
  if (PyUnicode_Check(raw) != 0) return {object.cast<std::string>()};
  if (py::isinstance<GuideSpec>(object)) return {object.cast<GuideSpec>()};
  if (py::isinstance<StrategySpec>(object)) return {object.cast<StrategySpec>()};
  if (py::isinstance<ValueObject>(object)) return {object.cast<const ValueObject&>().held};
  if (const Problem* problem = Language::one().place().problem_of(object)) return {*problem};
  if (PyList_Check(raw) != 0 || PyTuple_Check(raw) != 0) return list_of(object, what, depth);
  if (PyDict_Check(raw) != 0) return fields_of(object, what, depth);
  if (PyFunction_Check(raw) != 0) {
    if (has(object, "_word")) return {WordName{object.attr("_word").cast<std::string>()}};
    throw Error(what + ": functions are written in the language, in a script (trellis.load); got " + text_of(object));
  }
  if (has(object, "tolist")) return node_of(object.attr("tolist")(), what, depth);  // an array, or a number of numpy
  if (has(object, "__fspath__")) return {object.attr("__fspath__")().cast<std::string>()};
  if (PyIndex_Check(raw) != 0) return read_int(py::reinterpret_steal<py::object>(PyNumber_Index(raw)), what);
  if (PyNumber_Check(raw) != 0 && has(object, "__float__"))
    return {py::float_(py::reinterpret_borrow<py::object>(object)).cast<double>()};
  if (PyRange_Check(raw) != 0) return list_of(object, what, depth);
  if (has(object, "keys") && has(object, "items") && !has(object, "columns")) return fields_of(object, what, depth);
  throw Error(what + ": numbers, texts, lists, dicts and values of the language are accepted, got " + text_of(object) +
              (has(object, "columns") ? "; a frame's array is frame.to_numpy()" : ""));
}

/// The arguments as the language takes them: those with names in one table, which ends the call.
/// \param arguments  names of those that a word takes before its table
std::vector<Node> arguments_of(const std::string& name, const std::vector<std::string>& arguments,
                               const py::args& given, const py::kwargs& named) {
  std::vector<Node> all;
  Node::Fields fields;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const std::string what = name + ": " + (i < arguments.size() ? arguments[i] : "argument " + std::to_string(i + 1));
    all.push_back(node_of(given[i], what));
  }
  bool table = false;
  for (const auto& [key, value] : named) {
    const auto field = key.cast<std::string>();
    Node node = node_of(value, name + ": " + field);
    const auto place = std::find(arguments.begin(), arguments.end(), field);
    if (place == arguments.end()) {
      fields.emplace_back(field, std::move(node));
      table = true;
      continue;
    }
    const auto at = static_cast<std::size_t>(place - arguments.begin());
    if (at < given.size()) throw Error(name + ": '" + field + "' is given twice, with its name and without");
    if (at >= all.size()) all.resize(at + 1);
    all[at] = std::move(node);
  }
  if (!table) return all;
  // What stands before the named ones is the table's list.
  if (all.size() > arguments.size()) {
    std::int64_t number = 0;
    Node::Fields list;
    for (std::size_t i = arguments.size(); i < all.size(); ++i) list.emplace_back(++number, std::move(all[i]));
    all.resize(arguments.size());
    list.insert(list.end(), std::make_move_iterator(fields.begin()), std::make_move_iterator(fields.end()));
    fields = std::move(list);
  }
  all.resize(arguments.size());
  all.push_back({std::move(fields)});
  return all;
}

const dsl::Word& word_named(const std::string& name) {
  for (const dsl::Word& word : dsl::words()) {
    if (word.name == name) return word;
  }
  throw Error("the language has no word '" + name + "'");
}

std::vector<std::string> names_of(const std::vector<dsl::Field>& fields) {
  std::vector<std::string> names;
  for (const dsl::Field& field : fields) names.push_back(field.name);
  return names;
}

/// What pickle calls: a word with its arguments.
py::object reduced(const Recipe& recipe) {
  py::tuple arguments(recipe.arguments.size());
  for (std::size_t i = 0; i < recipe.arguments.size(); ++i) {
    arguments[i] = Language::one().object_of(recipe.arguments[i]);
  }
  return py::make_tuple(py::module_::import("trellis._language").attr("made_by"),
                        py::make_tuple(recipe.word, std::move(arguments)));
}

[[noreturn]] void refuse_pickle(const py::object& of) {
  throw Error(text_of(of) + " cannot be pickled: only what a word or an expression made can be");
}

/// Of a strategy or guide its text, where reading it gives the same one.
py::object reduced_text(const py::object& of, const char* read) {
  const py::object again = py::module_::import("trellis").attr(read);
  const py::object text = py::str(of);
  try {
    if (again(text).equal(of)) return py::make_tuple(again, py::make_tuple(text));
  } catch (const py::error_already_set&) {
  }
  refuse_pickle(of);
}

constexpr const char* recipe_of_problem = "_made_by";

py::object call_word(const std::string& name, const py::args& given, const py::kwargs& named) {
  const dsl::Word& word = word_named(name);
  const std::vector<std::string> arguments = names_of(word.arguments);
  const std::vector<Node> all = arguments_of(name, arguments, given, named);
  if (name == "require") {
    const auto* module = all.size() == 1 ? std::get_if<std::string>(&all.front().value) : nullptr;
    if (module != nullptr && !dsl::module_text(*module)) {
      throw Error("require: the standard library has no module '" + *module + "'; trellis.load runs scripts");
    }
  }
  const auto pace = word.kind < dsl::Word::Kind::constructor ? Language::Pace::quick : Language::Pace::slow;
  const py::object made = Language::one().call([&](lua::Stack& stack) { push_word(stack, name); }, all, pace, 2);
  const auto recipe = std::make_shared<const Recipe>(Recipe{name, all});
  if (py::isinstance<ValueObject>(made)) {
    made.cast<const ValueObject&>().held->recipe = recipe;
  } else if (Language::one().place().problem_of(made) != nullptr) {
    py::setattr(made, recipe_of_problem, py::cpp_function([recipe] { return reduced(*recipe); }));
  }
  return made;
}

/// Whether two problems are alike in all but what made them. Those with motion models are only where they share it.
bool same_problem(const Problem& a, const Problem& b) {
  const auto numbers = [](const Problem& p) {
    return std::tie(p.name, p.start, p.goals, p.goal_tolerance, p.resolution, p.contact_tolerance, p.collision,
                    p.motion_model);
  };
  if (numbers(a) != numbers(b) || a.space.factors() != b.space.factors()) return false;
  const auto scenery = [](const Problem& p) {
    trellis::Experiment experiment;
    experiment.problems = {p};
    return trellis::scenery_of(experiment);
  };
  const trellis::Scenery left = scenery(a), right = scenery(b);
  return std::tie(left.worlds, left.robots, left.scenes) == std::tie(right.worlds, right.robots, right.scenes);
}

/// Applies an operator of Lua; NotImplemented for an operand that is no value of the language.
py::object operate(const std::string& text, const py::object& a, const py::object& b) {
  std::vector<Node> operands;
  try {
    operands = {node_of(a, text), node_of(b, text)};
  } catch (const Error&) {
    return py::reinterpret_borrow<py::object>(Py_NotImplemented);
  }
  return Language::one().call([&](lua::Stack& stack) { push_text(stack, "local a, b = ...; return " + text); },
                              operands, Language::Pace::quick);
}

/// A member of a value. A method is a function without its first argument.
py::object member(const py::object& of, const std::string& name) {
  const auto absent = [&](const std::string& why) {
    PyErr_SetString(PyExc_AttributeError, why.c_str());
    throw py::error_already_set();
  };
  if (name.starts_with('_')) absent("no attribute '" + name + "'");
  const Node self = node_of(of, "self");
  py::object found;
  try {
    found = Language::one().call([](lua::Stack& stack) { push_text(stack, "local a, b = ...; return a[b]"); },
                                 {self, {name}}, Language::Pace::quick);
  } catch (const Error& error) {
    absent(error.what());
  }
  if (found.is_none()) absent(text_of(of) + " has no attribute '" + name + "'");
  if (!py::isinstance<ValueObject>(found)) return found;
  const std::shared_ptr<StoredValue> held = found.cast<const ValueObject&>().held;
  if (held->kind() != "a function") return found;
  return py::cpp_function(
      [held, self, name](const py::args& given, const py::kwargs& named) {
        std::vector<Node> all = arguments_of(name, {}, given, named);
        all.insert(all.begin(), self);
        return Language::one().call([&](lua::Stack& stack) { held->push(stack); }, all, Language::Pace::slow);
      },
      py::name(name.c_str()));
}

std::string to_text(const py::object& value);

/// Equal by the language, by the calls that made them, or targets with the same text.
py::object equal_values(const py::object& a, const py::object& b) {
  const py::object equal = operate("a == b", a, b);
  if (!py::isinstance<ValueObject>(b) || equal.is(py::bool_(true))) return equal;
  const StoredValue& left = *a.cast<const ValueObject&>().held;
  const StoredValue& right = *b.cast<const ValueObject&>().held;
  if (left.kind() != right.kind()) return py::bool_(false);
  if (left.recipe && right.recipe && reduced(*left.recipe).equal(reduced(*right.recipe))) return py::bool_(true);
  return py::bool_(left.kind() == "a target" && to_text(a) == to_text(b));
}

std::string to_text(const py::object& value) {
  return Language::one()
      .call([](lua::Stack& stack) { push_text(stack, "return tostring(...)"); }, {node_of(value, "str")},
            Language::Pace::quick)
      .cast<std::string>();
}

template <class Function>
void add_method(const py::object& type, const char* name, const Function& function) {
  py::setattr(type, name, py::cpp_function(function, py::name(name), py::is_method(type)));
}

void add_operators(const py::object& type) {
  using Pair = std::pair<const char*, const char*>;
  for (const auto& [name, text] : {Pair{"__rshift__", "a >> b"}, Pair{"__add__", "a + b"}, Pair{"__mul__", "a * b"}}) {
    add_method(type, name,
               [text = std::string(text)](const py::object& a, const py::object& b) { return operate(text, a, b); });
  }
  for (const auto& [name, text] :
       {Pair{"__rrshift__", "a >> b"}, Pair{"__radd__", "a + b"}, Pair{"__rmul__", "a * b"}}) {
    add_method(type, name,
               [text = std::string(text)](const py::object& b, const py::object& a) { return operate(text, a, b); });
  }
}

/// Values do not change, so a copy is the value itself.
void add_copies(const py::object& type) {
  add_method(type, "__copy__", [](const py::object& self) { return self; });
  add_method(type, "__deepcopy__", [](const py::object& self, const py::object&) { return self; });
}

void add_members(const py::object& type) { add_method(type, "__getattr__", member); }

py::list word_list() {
  py::list all;
  for (const dsl::Word& word : dsl::words()) {
    py::dict entry;
    entry["name"] = word.name;
    entry["kind"] = std::string(word.kind_text());
    entry["module"] = word.module();
    entry["is_module"] = word.kind == dsl::Word::Kind::module;
    entry["summary"] = word.summary;
    entry["signature"] = word.kind == dsl::Word::Kind::module ? "" : dsl::python_signature(word);
    all.append(std::move(entry));
  }
  return all;
}

}  // namespace

void add_language(py::module_& module, LanguagePlace place) {
  Language::one().set_place(std::move(place));
  py::class_<ValueObject> value(module, "Value",
                                "A value of the language, as a world, a robot or a target. Immutable.");
  value.def("__str__", &to_text)
      .def(
          "__repr__",
          [](const py::object& self) { return "<trellis.Value " + self.cast<const ValueObject&>().held->kind() + ">"; })
      .def("__eq__", &equal_values)
      .def("__hash__", [](const py::object& self) { return py::hash(py::str(to_text(self))); })
      .def("__call__", [](const ValueObject& self, const py::args& given, const py::kwargs& named) {
        return Language::one().call([&](lua::Stack& stack) { self.held->push(stack); },
                                    arguments_of(self.held->kind(), {}, given, named), Language::Pace::slow);
      });
  add_operators(value);
  add_members(value);
  for (const char* name : {"Guide", "Strategy"}) add_operators(module.attr(name));
  const py::object problem = module.attr("Problem");
  add_members(problem);
  add_method(problem, "__eq__", [](const py::object& a, const py::object& b) -> py::object {
    const auto& problem_of = Language::one().place().problem_of;
    const Problem* other = problem_of(b);
    if (other == nullptr) return py::reinterpret_borrow<py::object>(Py_NotImplemented);
    return py::bool_(a.is(b) || same_problem(*problem_of(a), *other));
  });
  add_method(problem, "__hash__", [](const py::object& self) {
    return std::hash<std::string>()(Language::one().place().problem_of(self)->name);
  });
  const py::object strategy = module.attr("Strategy");
  add_method(strategy, "tree", &StrategySpec::tree);
  add_method(strategy, "json", &StrategySpec::json);
  add_method(strategy, "hash", [](const py::object& self) {
    return Language::one().call([](lua::Stack& stack) { push_text(stack, "return (...):hash()"); },
                                {node_of(self, "hash")}, Language::Pace::quick);
  });
  add_method(value, "__reduce__", [](const py::object& self) {
    const auto& recipe = self.cast<const ValueObject&>().held->recipe;
    if (!recipe) refuse_pickle(self);
    return reduced(*recipe);
  });
  add_method(strategy, "__reduce__", [](const py::object& self) { return reduced_text(self, "strategy"); });
  add_method(module.attr("Guide"), "__reduce__", [](const py::object& self) { return reduced_text(self, "guide"); });
  add_method(problem, "__reduce__", [](const py::object& self) -> py::object {
    if (!py::hasattr(self, recipe_of_problem)) refuse_pickle(self);
    return self.attr(recipe_of_problem)();
  });
  for (const char* name : {"Guide", "Strategy", "Problem", "Value"}) add_copies(module.attr(name));
  module.def("words", &word_list);
  module.def("help_text", [](const std::string& name) { return dsl::help_text(name); });
  module.def("call", [](const std::string& name, const py::tuple& given, const py::dict& named) {
    return call_word(name, py::args(given), py::kwargs(named));
  });
}
