// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/language/core/construct.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include <dsl/language/core/replaced.hpp>

namespace trellis::dsl {

namespace {

using lua::Type;
using lua::Value;

std::vector<std::string> names_of(const Construct& construct) {
  std::vector<std::string> names;
  for (const auto& field : construct.fields) names.push_back(field.name);
  for (const auto& option : construct.options.options) names.push_back(option.name);
  return names;
}

std::string joined(const std::vector<std::string>& names) {
  std::string all;
  for (const auto& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

/// Reads a name in a list of names: text, or a whole number, converted to text.
std::optional<std::string> name_of(Value value) {
  if (value.is_integer()) return fmt::format("{}", *value.integer());
  return value.string();
}

/// Converts a value to an option's value; none for other types.
std::optional<OptionValue> option_value(Value value) {
  if (value.is_integer()) return OptionValue(*value.integer());
  if (const auto number = value.number()) return OptionValue(*number);
  if (const auto boolean = value.boolean()) return OptionValue(*boolean);
  if (const auto text = value.string()) return OptionValue(*text);
  if (value.type() != Type::table || !value.keys().names.empty() || !value.keys().odd.empty()) return {};
  std::vector<std::string> names;
  bool all = true;
  value.each([&](std::size_t, Value element) {
    const auto name = name_of(element);
    all = all && name;
    if (name) names.push_back(*name);
  });
  return all ? std::optional(OptionValue(std::move(names))) : std::nullopt;
}

}  // namespace

void read_option(const Component& component, const std::string& name, Value value, std::vector<Options::Entry>& given) {
  const auto taken = std::any_of(given.begin(), given.end(), [&](const auto& entry) { return entry.first == name; });
  if (taken) {
    throw Error(fmt::format("{}: option '{}' is given twice, with its name and without", component.name, name));
  }
  const Option* option = component.find(name);
  const bool list = value.type() == Type::table;
  auto converted =
      option != nullptr && list && option->type != Option::Type::names ? std::nullopt : option_value(value);
  if (option != nullptr && option->type == Option::Type::names) {
    // A list of one name may be written as the name.
    if (const auto one = value.string()) converted = std::vector<std::string>{*one};
  }
  if (option != nullptr && !converted) {
    throw Error(
        fmt::format("{}: option '{}' must be {}, got {}", component.name, name, expectation(*option), describe(value)));
  }
  given.emplace_back(name, converted.value_or(false));
}

namespace {

std::string unnamed(const Component& component) {
  if (component.positional.empty()) return "takes no option without a name";
  return fmt::format("takes {} without a name ({})",
                     component.positional.size() == 1 ? std::string("one option")
                                                      : fmt::format("{} options", component.positional.size()),
                     joined(component.positional));
}

/// Reads one call's options; see read_options.
class OptionReader {
 public:
  OptionReader(const Component& component, bool planner) : component_(component), takes_planner_(planner) {}

  void unnamed_option(Value value) {
    if (const auto* planner = value.get<PlannerSpec>(); planner != nullptr && takes_planner_) {
      throw Error(fmt::format("{}: a planner is given by name: planner = {}", component_.name, planner->text()));
    }
    if (next_ >= component_.positional.size()) {
      throw Error(fmt::format("{}: {}, got {}; name the others, as in {} {{ name = value }}", component_.name,
                              unnamed(component_), describe(value), component_.name));
    }
    const std::string& name = component_.positional[next_];
    if (!value.given()) throw Error(fmt::format("{}: option '{}' is nil", component_.name, name));
    if (component_.find(name)->type == Option::Type::names) {
      add_name(name, value);
      return;
    }
    ++next_;
    read_option(component_, name, value, given_.options);
  }

  void table(Value table) {
    const lua::Keys keys = table.keys();
    if (!keys.odd.empty()) {
      throw Error(fmt::format("{}: options are named, or given in order; got {}", component_.name, keys.odd));
    }
    bool in_order = true;  // after one positional option that is no such, the others' meaning is unknown
    table.each(
        [&](std::size_t, Value value) { in_order = in_order && faults_.attempt([&] { unnamed_option(value); }); });
    for (const auto& name : keys.names) {
      faults_.attempt([&] { named(name, table.field(name)); });
    }
  }

  Given take() {
    if (!faults_.none()) {
      for (const auto& entry : given_.options) {
        faults_.attempt([&] { Options::validate(component_, {entry}); });
      }
    }
    faults_.raise();
    return std::move(given_);
  }

 private:
  /// Adds an element of the list that ends the positional options.
  void add_name(const std::string& option, Value value) {
    const auto element = name_of(value);
    if (!element) throw Error(fmt::format("{}: expected a name, got {}", component_.name, describe(value)));
    auto& options = given_.options;
    const auto begun = std::find_if(options.begin(), options.end(), [&](const auto& e) { return e.first == option; });
    if (begun == options.end()) {
      options.emplace_back(option, std::vector<std::string>{*element});
    } else {
      std::get<std::vector<std::string>>(begun->second).push_back(*element);
    }
  }

  void named(const std::string& name, Value value) {
    constexpr const char* planner_name = "planner";
    if (takes_planner_ && name == planner_name) {
      const auto* planner = value.get<PlannerSpec>();
      if (planner == nullptr) {
        throw Error(fmt::format("{}: option 'planner' must be a planner, as rrt_connect {{}}, got {}", component_.name,
                                describe(value)));
      }
      given_.planner = *planner;
      return;
    }
    if (takes_planner_ && component_.find(name) == nullptr) {
      std::vector<std::string> known = {planner_name};
      for (const auto& option : component_.options) known.push_back(option.name);
      if (nearest_name(name, known) == planner_name) {
        throw Error(fmt::format("{}: unknown option '{}'{}", component_.name, name, did_you_mean(name, known)));
      }
    }
    read_option(component_, name, value, given_.options);
  }

  const Component& component_;
  bool takes_planner_;
  std::size_t next_ = 0;  // index of the next positional option
  Given given_;
  lua::Faults faults_;
};

}  // namespace

Arguments::Arguments(const Construct& construct, lua::Stack& call) : construct_(construct), call_(call) {
  lua::Faults faults;
  read(faults);
  if (faults.none()) return;
  if (readable_ && !construct.options.options.empty()) {
    faults.attempt([&] { static_cast<void>(options()); });
  }
  faults.raise();
}

Arguments::Arguments(const Construct& construct, lua::Stack& call, lua::Faults& faults)
    : construct_(construct), call_(call) {
  read(faults);
}

void Arguments::read(lua::Faults& faults) {
  readable_ = faults.attempt([&] {
    if (call_.count() == 1 && call_[1].type() == Type::table) {
      table_ = call_[1];
      read_keys(faults);
    } else {
      count_ = static_cast<std::size_t>(call_.count());
    }
    if (count_ > 0 && construct_.list.empty()) {
      std::string first;
      each([&](std::size_t i, Value value) { first = i == 1 ? describe(value) : first; });
      throw Error(
          fmt::format("{}: takes named fields only, as in {}; got {}", construct_.name, construct_.usage, first));
    }
  });
  if (!readable_) return;
  for (const auto& field : construct_.fields) {
    const bool misspelt = std::find(misspelt_.begin(), misspelt_.end(), field.name) != misspelt_.end();
    if (field.required && !misspelt && !(*this)[field.name].given()) {
      faults.add(
          fmt::format("{}: field '{}' is missing: {}, {}", construct_.name, field.name, field.expects, field.doc));
    }
  }
}

void Arguments::read_keys(lua::Faults& faults) {
  const lua::Keys keys = table_->keys();
  if (!keys.odd.empty()) {
    throw Error(
        fmt::format("{}: fields have names, elements the numbers 1, 2, ...; got {}", construct_.name, keys.odd));
  }
  count_ = keys.length;
  const auto known = names_of(construct_);
  for (const auto& name : keys.names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    misspelt_.push_back(nearest_name(name, known));
    faults.add(fmt::format("{}: unknown field '{}'{}{}", construct_.name, name, suggestion(name, known),
                           known.empty() ? "; it has none" : "; its fields are: " + joined(known)));
  }
}

void Arguments::each(const std::function<void(std::size_t, Value)>& visit) const {
  if (table_) {
    table_->each(visit);
  } else {
    for (std::size_t i = 1; i <= count_; ++i) visit(i, call_[static_cast<int>(i)]);
  }
}

Value Arguments::operator[](const std::string& name) const {
  if (table_) return table_->field(name);
  call_.push_nil();
  return call_.top();
}

std::optional<std::string> Arguments::string(const std::string& name) const {
  const Value value = (*this)[name];
  if (!value.given()) return {};
  auto text = value.string();
  if (!text) reject(name);
  return text;
}

Options Arguments::options() const {
  lua::Faults faults;
  std::vector<Options::Entry> given;
  for (const auto& option : construct_.options.options) {
    const Value value = (*this)[option.name];
    if (!value.given()) continue;
    faults.attempt([&] { read_option(construct_.options, option.name, value, given); });
  }
  if (faults.none()) return validated(construct_.options, given);
  for (const auto& entry : given) {
    faults.attempt([&] { Options::validate(construct_.options, {entry}); });
  }
  faults.raise();
  return {};
}

Options validated(const Component& component, const std::vector<Options::Entry>& given) {
  lua::Faults faults;
  for (const auto& entry : given) {
    faults.attempt([&] { Options::validate(component, {entry}); });
  }
  faults.raise();
  return Options::validate(component, given);
}

void Arguments::reject(const std::string& name) const {
  const auto& fields = construct_.fields;
  const auto field = std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.name == name; });
  if (field == fields.end()) throw Fault(construct_.name + " has no field " + name);
  throw Error(
      fmt::format("{}: field '{}' must be {}, got {}", construct_.name, name, field->expects, describe((*this)[name])));
}

Given read_options(const Component& component, lua::Stack& call, int first, bool planner) {
  OptionReader reader(component, planner);
  const int last = call.count();
  for (int i = first; i <= last; ++i) {
    const Value value = call[i];
    if (value.type() != Type::table) {
      reader.unnamed_option(value);
    } else if (i == last) {
      reader.table(value);
    } else {
      throw Error(fmt::format("{}: one table of options ends the call; there is more after it", component.name));
    }
  }
  return reader.take();
}

std::vector<double> read_numbers(Value value, const std::string& what) {
  if (value.type() != Type::table)
    throw Error(fmt::format("{} must be a list of numbers, got {}", what, describe(value)));
  const lua::Keys keys = value.keys();
  if (!keys.odd.empty()) throw Error(fmt::format("{} must be a list of numbers, got one with {}", what, keys.odd));
  if (!keys.names.empty()) {
    throw Error(fmt::format("{} must be a list of numbers, got one with the field '{}'", what, keys.names.front()));
  }
  std::vector<double> numbers;
  value.each([&](std::size_t i, Value element) {
    const auto number = element.number();
    if (!number || !std::isfinite(*number)) {
      throw Error(fmt::format("{} must be a list of finite numbers, got {} as number {}", what, describe(element), i));
    }
    numbers.push_back(*number);
  });
  return numbers;
}

void place_files(const Component& component, std::vector<Options::Entry>& given, const ScriptPlace& place) {
  for (const Option& option : component.options) {
    if (option.type != Option::Type::file) continue;
    auto entry = std::find_if(given.begin(), given.end(), [&](const auto& e) { return e.first == option.name; });
    const bool by_default = entry == given.end();
    if (by_default) entry = given.insert(given.end(), {option.name, option.default_value});
    auto* file = std::get_if<std::string>(&entry->second);
    if (file == nullptr || file->empty()) continue;  // the validation of the options reports this
    if (!place.trust && !lies_within(*file, {place.folder})) {
      throw Error(fmt::format(
          "{}: option '{}': '{}' does not lie in the script's folder; --trust lets a script that you trust read it",
          component.name, option.name, *file));
    }
    const std::filesystem::path path = (std::filesystem::path(place.folder) / *file).lexically_normal();
    std::error_code ignored;
    if (!by_default && !std::filesystem::exists(path, ignored)) {
      throw Error(fmt::format("{}: option '{}': there is no file '{}': {}", component.name, option.name, path.string(),
                              option.doc));
    }
    const std::string name = std::exchange(*file, path.string());
    if (place.watch && std::filesystem::is_regular_file(path, ignored)) place.watch(name, *file);
  }
}

lua::Callback missing_field(const std::string& module) {
  return [module](lua::Stack& call) -> int {
    const auto name = call[2].string();
    const auto known = call[1].keys().names;
    if (!name) throw Error(fmt::format("{} has no field {}", module, describe(call[2])));
    throw Error(
        fmt::format("{} has no '{}'{}; it has: {}", module, *name, suggestion(*name, known, module), joined(known)));
  };
}

std::optional<StrategySpec> as_strategy(lua::Value value) {
  if (const auto* strategy = value.get<StrategySpec>()) return *strategy;
  if (const auto* planner = value.get<PlannerSpec>()) return StrategySpec(*planner);
  return {};
}

std::string describe(Value value) {
  const auto quoted = [](const char* type, std::string text) {
    constexpr std::size_t longest = 100;
    if (text.size() > longest) {
      text.resize(longest);
      text += "...";
    }
    return fmt::format("the {} '{}'", type, text);
  };
  if (const auto* planner = value.get<PlannerSpec>()) return quoted("planner", planner->text());
  if (const auto* guide = value.get<GuideSpec>()) return quoted("guide", guide->text());
  if (const auto* strategy = value.get<StrategySpec>()) return quoted("strategy", strategy->text());
  if (value.get<TargetSpec>() != nullptr) return quoted("target", value.text());
  if (const auto* estimator = value.get<EstimatorSpec>()) return quoted("estimator", estimator->text());
  if (const auto* constructor = value.get<Constructor>()) {
    const std::string& name = constructor->component->name;
    return fmt::format("the constructor '{}' (call it: {}())", name, name);
  }
  return value.describe();
}

}  // namespace trellis::dsl
