// SPDX-License-Identifier: MIT-0
// trellis._trellis: what the Python package calls. python/trellis/__init__.py is what users call, and documents it.
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include <dsl/command/case_file.hpp>
#include <dsl/command/measurement.hpp>
#include <dsl/command/provenance.hpp>
#include <dsl/language/core/construct.hpp>
#include <dsl/language/core/program.hpp>
#include <dsl/language/tools/session.hpp>
#include <dsl/language/words/ends.hpp>
#include <dsl/language/words/robot_queries.hpp>
#include <dsl/lua/mistakes.hpp>
#include <trellis/base/error.hpp>
#include <trellis/base/errors.hpp>
#include <trellis/base/version.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/experiment/input_warnings.hpp>
#include <trellis/experiment/unused.hpp>
#include <trellis/instance/end_fault.hpp>
#include <trellis/instance/instance.hpp>
#include <trellis/instance/resolve_goal.hpp>
#include <trellis/pictures/packed_run.hpp>
#include <trellis/pictures/scenery.hpp>
#include <trellis/report/report.hpp>
#include <trellis/results/directories.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>

#include "call.hpp"
#include "function_guide.hpp"
#include "language.hpp"
#include "sampler.hpp"

namespace py = pybind11;

namespace {

using trellis::Configuration;
using trellis::Configurations;
using trellis::Error;
using trellis::Experiment;
using trellis::GuideSpec;
using trellis::Instance;
using trellis::Interrupted;
using trellis::Problem;
using trellis::StrategySpec;
using trellis::View;
namespace command = trellis::command;
namespace dsl = trellis::dsl;

// Interruption
// ---------------------------------------------------------------------------------------------------------------

/// Calls `body` in a thread of its own. Meanwhile this thread handles Python's signals and calls `meanwhile`, both with
/// the GIL, which it releases in between. \throws what `body`, a signal's handler or `meanwhile` throws.
void interruptibly(const std::function<void()>& body, const std::function<void()>& meanwhile = {}) {
  constexpr std::chrono::milliseconds interval(50);
  const Call call;
  std::mutex mutex;
  std::condition_variable changed;
  bool ended = false;
  std::exception_ptr failure, raised;
  std::thread worker([&] {
    try {
      // Python keeps what it has of this thread meanwhile, so that calls of functions in Python cost less.
      const py::gil_scoped_acquire held;
      const py::gil_scoped_release released;
      body();
    } catch (...) {
      failure = std::current_exception();
    }
    const std::scoped_lock lock(mutex);
    ended = true;
    changed.notify_one();
  });
  {
    const py::gil_scoped_release released;
    std::unique_lock lock(mutex);
    while (!changed.wait_for(lock, interval, [&] { return ended; })) {
      lock.unlock();
      if (!raised) {
        const py::gil_scoped_acquire held;
        try {
          if (PyErr_CheckSignals() != 0) throw py::error_already_set();
          if (meanwhile) meanwhile();
        } catch (...) {
          raised = std::current_exception();
          Call::stop();
        }
      }
      lock.lock();
    }
    lock.unlock();
    worker.join();
  }
  if (raised) std::rethrow_exception(raised);
  if (failure) std::rethrow_exception(failure);
}

// Scripts
// --------------------------------------------------------------------------------------------------------------------

struct Script {
  std::string path;
  dsl::Program program;
};

dsl::SessionOptions session_options(bool trust, std::uint64_t seed) {
  dsl::SessionOptions options;
  options.trust = trust;
  options.seed = seed;
  options.interrupted = Call::is_stopped;
  return options;
}

std::shared_ptr<Script> load(const std::string& path, bool trust, std::uint64_t seed) {
  auto script = std::make_shared<Script>(Script{path, {}});
  interruptibly([&] { script->program = dsl::load_script(path, session_options(trust, seed)); });
  return script;
}

std::shared_ptr<Script> load_text(const std::string& text, const std::string& folder, bool trust, std::uint64_t seed) {
  auto script = std::make_shared<Script>();
  interruptibly([&] { script->program = dsl::Session(folder, session_options(trust, seed)).load(text, "text"); });
  return script;
}

/// The value of an expression.
/// \param as  returns it, or none for a value of another kind
/// \param expected  what it is, for messages
template <class As>
auto value_of(const std::string& text, const std::string& folder, const char* kind, const char* expected,
              const As& as) {
  decltype(as(std::declval<trellis::lua::Value>())) made;
  interruptibly([&] {
    dsl::Session session(folder, session_options(false, 1));
    session.run("return " + text, kind, [&](trellis::lua::Stack& stack) {
      if (stack.size() == 1) made = as(stack[1]);
      if (made) return;
      throw Error(std::string("this is no ") + kind + ", " + expected + ": it is " +
                  (stack.size() == 0 ? "nothing" : dsl::describe(stack[1])));
    });
  });
  return *made;
}

StrategySpec strategy(const std::string& text, const std::string& folder) {
  return value_of(text, folder, "strategy", "as guide >> planner, or a planner", dsl::as_strategy);
}

GuideSpec guide(const std::string& text, const std::string& folder) {
  return value_of(text, folder, "guide", "as skeleton() >> lazy()", [](trellis::lua::Value value) {
    const auto* found = value.get<GuideSpec>();
    return found != nullptr ? std::optional(*found) : std::nullopt;
  });
}

std::vector<Problem> problems(const std::string& text, const std::string& folder) {
  std::vector<Problem> found;
  interruptibly([&] { found = dsl::Session(folder, session_options(false, 1)).problems("return " + text, "problem"); });
  return found;
}

// Problems
// -------------------------------------------------------------------------------------------------------------------

/// A problem, and its checker, which the first check makes.
class CheckedProblem {
 public:
  explicit CheckedProblem(Problem problem) : problem_(std::move(problem)) {}

  [[nodiscard]] const Problem& problem() const { return problem_; }
  [[nodiscard]] bool valid(const Configuration& q) {
    const std::size_t dimension = problem_.space.dimension();
    if (q.size() != dimension) {
      throw Error(problem_.name + ": a configuration has " + std::to_string(dimension) + " coordinates, got " +
                  std::to_string(q.size()));
    }
    if (!instance_) instance_ = trellis::make_instance(problem_);
    return instance_->space.contains(q) && instance_->validity->state(q);
  }
  /// Why a configuration is not valid; "" where it is.
  [[nodiscard]] std::string fault(const Configuration& q) {
    if (valid(q)) return "";
    return trellis::EndChecker(problem_).fault(q).text;
  }
  /// \throws Error for a robot that is not one of a URDF file
  [[nodiscard]] const trellis::SphereModel& arm(const char* what) const {
    const trellis::ManipulatorScene* scene = problem_.scene->manipulator();
    if (scene == nullptr) throw Error(problem_.name + ": " + what + " is for robots of URDF files");
    return scene->robot;
  }

 private:
  Problem problem_;
  std::shared_ptr<Instance> instance_;
};

/// Of one configuration a bool, of an array of N rows an array of N.
py::object valid(CheckedProblem& problem, const py::object& q) {
  if (!py::hasattr(q, "ndim") || q.attr("ndim").cast<int>() != 2)
    return py::bool_(problem.valid(q.cast<Configuration>()));
  using Rows = py::array_t<double, py::array::c_style | py::array::forcecast>;
  const auto rows = q.cast<Rows>();
  py::array_t<bool> answers(rows.shape(0));
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    const double* row = rows.data(i, 0);
    answers.mutable_at(i) = problem.valid(Configuration(row, row + rows.shape(1)));
  }
  return answers;
}

/// Returns one value of each coordinate of a problem's space.
template <class T>
std::vector<T> of_axes(const CheckedProblem& problem, T trellis::Axis::*member) {
  std::vector<T> values;
  for (const trellis::Axis& axis : problem.problem().space.coordinates()) values.push_back(axis.*member);
  return values;
}

std::vector<std::vector<std::string>> rotations_of(const CheckedProblem& problem) {
  const std::vector<std::string> names = of_axes(problem, &trellis::Axis::name);
  std::vector<std::vector<std::string>> rotations;
  for (const trellis::Factor& factor : problem.problem().space.factors()) {
    if (factor.kind != trellis::Factor::Kind::rotation) continue;
    const auto begin = names.begin() + static_cast<std::ptrdiff_t>(factor.column);
    rotations.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(factor.width()));
  }
  return rotations;
}

py::list joints(const CheckedProblem& problem) {
  py::list all;
  for (const dsl::JointInfo& info : dsl::joint_infos(problem.arm("joints"))) {
    py::dict joint;
    joint["name"] = info.name;
    joint["kind"] = info.kind;
    joint["lower"] = info.limited ? py::object(py::float_(info.lower)) : py::object(py::none());
    joint["upper"] = info.limited ? py::object(py::float_(info.upper)) : py::object(py::none());
    joint["velocity"] = info.velocity > 0.0 ? py::object(py::float_(info.velocity)) : py::object(py::none());
    all.append(std::move(joint));
  }
  return all;
}

/// \param seed  a number, or a configuration
std::vector<Configuration> ik(const CheckedProblem& problem, const std::string& link,
                              const std::array<double, 3>& position, const std::optional<std::array<double, 3>>& rpy,
                              const std::optional<std::array<double, 4>>& quaternion,
                              const std::pair<double, double>& within,
                              const std::variant<std::uint64_t, Configuration>& seed, std::size_t count) {
  const trellis::SphereModel& robot = problem.arm("ik");
  if (rpy && quaternion) throw Error("ik: an orientation is given once: by rpy or by quaternion");
  if (!(within.first > 0.0) || !(within.second > 0.0)) throw Error("ik: within has two numbers greater than 0");
  if (count == 0) throw Error("ik: count is at least 1");
  trellis::LinkTarget target;
  target.link = dsl::link_named(robot, link, "ik: link");
  target.pose.position = {position[0], position[1], position[2]};
  if (rpy) {
    const auto& [roll, pitch, yaw] = *rpy;
    target.pose.orientation =
        trellis::normalised(trellis::rotation_of({0.0, 0.0, yaw}) *
                            (trellis::rotation_of({0.0, pitch, 0.0}) * trellis::rotation_of({roll, 0.0, 0.0})));
  } else if (quaternion) {
    const auto& [x, y, z, w] = *quaternion;
    if (!(std::abs(std::sqrt(x * x + y * y + z * z + w * w) - 1.0) <= 1e-3)) {
      throw Error("ik: a quaternion x, y, z, w has norm 1");
    }
    target.pose.orientation = trellis::normalised({x, y, z, w});
  }
  target.near = within.first;
  target.turn = within.second;
  trellis::ReachQuery query;
  query.targets = {target};
  query.most = count;
  if (const auto* first = std::get_if<Configuration>(&seed)) {
    if (first->size() != problem.problem().space.dimension()) {
      throw Error("ik: a configuration has " + std::to_string(problem.problem().space.dimension()) +
                  " coordinates, got " + std::to_string(first->size()));
    }
    query.first = *first;
  } else {
    query.seed = std::get<std::uint64_t>(seed);
  }
  std::vector<Configuration> found;
  interruptibly([&] { found = trellis::reach_configurations(problem.problem(), query).configurations; });
  return found;
}

py::dict named_problems(const Script& script) {
  py::dict found;
  for (const Problem& problem : script.program.experiment.problems) {
    found[py::str(problem.name)] = std::make_shared<CheckedProblem>(problem);
  }
  return found;
}

py::dict named_strategies(const Script& script) {
  py::dict found;
  for (const auto& [name, spec] : script.program.experiment.strategies) found[py::str(name)] = spec;
  return found;
}

LanguagePlace language_place() {
  return {.interruptibly = [](const std::function<void()>& body) { interruptibly(body); },
          .stopped = Call::is_stopped,
          .problem = [](Problem problem) { return py::cast(std::make_shared<CheckedProblem>(std::move(problem))); },
          .experiment =
              [](dsl::Program program) {
                return py::cast(std::make_shared<Script>(Script{"", std::move(program)}));
              },
          .problem_of = [](py::handle object) -> const Problem* {
            if (!py::isinstance<CheckedProblem>(object)) return nullptr;
            return &object.cast<const CheckedProblem&>().problem();
          }};
}

// Runs
// -----------------------------------------------------------------------------------------------------------------------

struct Request {
  std::shared_ptr<Script> script;  ///< nullptr: none
  std::vector<std::pair<std::string, StrategySpec>> strategies;
  std::vector<std::shared_ptr<CheckedProblem>> problems;
  std::vector<std::uint64_t> seeds;
};

/// Returns the experiment of a script, reduced to what is requested, or a new one.
Experiment experiment_of(const Request& request) {
  Experiment experiment;
  if (request.script) experiment = request.script->program.experiment;
  const bool fewer = request.strategies.size() != experiment.strategies.size() ||
                     request.problems.size() != experiment.problems.size();
  experiment.strategies = request.strategies;
  experiment.problems.clear();
  for (const auto& problem : request.problems) experiment.problems.push_back(problem->problem());
  experiment.seeds = request.seeds;
  if (!fewer) return experiment;
  const auto there = [&](const std::string& name) {
    return std::any_of(experiment.strategies.begin(), experiment.strategies.end(),
                       [&](const auto& entry) { return entry.first == name; });
  };
  std::erase_if(experiment.ablations, [&](const auto& link) { return !there(link.strategy) || !there(link.of); });
  if (!there(experiment.baseline)) experiment.baseline.clear();
  return experiment;
}

/// Returns the JSON document, the printed report, and the warnings.
std::tuple<std::string, std::string, std::vector<std::string>> run(
    const Request& request, const std::optional<std::string>& baseline, bool measured, unsigned jobs, unsigned threads,
    std::optional<double> ablation, std::optional<std::int64_t> cross, const std::optional<std::string>& samples,
    const std::optional<std::function<void(std::size_t, std::size_t)>>& progress) {
  constexpr int width = 100;
  Experiment experiment = experiment_of(request);
  if (baseline) experiment.baseline = *baseline;
  if (!measured) experiment.measure.reset();
  if (ablation) experiment.ablation = *ablation;
  if (cross) {
    if (!experiment.measure) throw Error("cross: the experiment measures nothing");
    experiment.measure->cross = *cross;
  }
  // Before the runs: a folder that cannot be made is no reason to lose them.
  if (samples) trellis::make_directory(*samples);
  std::tuple<std::string, std::string, std::vector<std::string>> answer;
  std::atomic<std::size_t> done = 0, all = 0;
  std::size_t shown = 0;
  const auto show = [&] {
    const std::size_t now = done;
    if (!progress || now == shown) return;
    shown = now;
    (*progress)(now, all);
  };
  interruptibly(
      [&] {
        const trellis::ExperimentResult result = trellis::run(experiment, {.jobs = jobs,
                                                                           .threads = threads,
                                                                           .progress =
                                                                               [&](std::size_t now, std::size_t steps) {
                                                                                 all = steps;
                                                                                 done = now;
                                                                               },
                                                                           .interrupted = Call::is_stopped});
        auto& [document, text, warnings] = answer;
        trellis::ExperimentFacts facts =
            trellis::facts_of(experiment, result, request.script ? request.script->path : "");
        facts.scenery = trellis::scenery_of(experiment);
        if (samples) {
          trellis::write_packed_samples(experiment, result, *samples);
          facts.samples = std::filesystem::absolute(*samples).generic_string();
        }
        const trellis::ExperimentSummary summary = trellis::summarise(facts);
        document = trellis::report_json(facts, summary);
        text = trellis::report_text(summary, width, trellis::ReportKind::overview);
        if (request.script) warnings = request.script->program.warnings;
        for (const std::string& sentence : trellis::input_warnings(experiment)) warnings.push_back(sentence);
        for (const std::string& sentence : trellis::unused_guides(experiment, result)) warnings.push_back(sentence);
      },
      show);
  show();
  return answer;
}

// Measurements
// ---------------------------------------------------------------------------------------------------------------

using Validity = std::variant<std::monostate, std::shared_ptr<CheckedProblem>, py::function>;

/// Returns the samples of an array of N rows.
Configurations samples_of(const py::buffer& buffer, std::size_t dimension) {
  const py::buffer_info info = buffer.request();
  if (info.ndim != 2 || info.format != py::format_descriptor<double>::format()) {
    throw Error("recorder: samples must be an array of numbers with two axes");
  }
  if (static_cast<std::size_t>(info.shape[1]) != dimension) {
    throw Error("recorder: a sample has " + std::to_string(dimension) + " coordinates, got " +
                std::to_string(info.shape[1]));
  }
  Configurations samples(dimension);
  Configuration q(dimension);
  const auto* bytes = static_cast<const char*>(info.ptr);
  for (py::ssize_t i = 0; i < info.shape[0]; ++i) {
    for (std::size_t j = 0; j < dimension; ++j) {
      q[j] =
          *reinterpret_cast<const double*>(bytes + i * info.strides[0] + static_cast<py::ssize_t>(j) * info.strides[1]);
    }
    samples.push(q);
  }
  return samples;
}

/// Returns the JSON document and the table of `trellis measure`.
std::pair<std::string, std::string> measure(const std::string& text, const std::string& folder,
                                            const py::buffer& buffer, const std::string& estimator,
                                            const Validity& validity) {
  command::Case c;
  interruptibly([&] { c = command::read_case_text(text, "recorder", folder, session_options(false, 1)); });
  Configurations samples = samples_of(buffer, c.space.dimension());
  const auto* problem = std::get_if<std::shared_ptr<CheckedProblem>>(&validity);
  const auto* function = std::get_if<py::function>(&validity);
  if (problem != nullptr) {
    const std::shared_ptr<Instance> instance = trellis::make_instance((*problem)->problem());
    if (instance->space.dimension() != c.space.dimension()) {
      throw Error("recorder: the problem '" + (*problem)->problem().name + "' has another number of coordinates");
    }
    c.valid = [instance](View q) { return instance->validity->state(q); };
    c.free = (*problem)->problem().name;
  } else if (function != nullptr) {
    c.valid = [function](View q) {
      const py::gil_scoped_acquire held;
      if (Call::is_stopped()) throw Interrupted();
      py::tuple coordinates(q.size());
      for (std::size_t j = 0; j < q.size(); ++j) coordinates[j] = q[j];
      return py::bool_((*function)(std::move(coordinates))).cast<bool>();
    };
    c.free = "valid";
  }
  if (c.valid) c.tube.support = trellis::TubeSettings::Support::free;
  std::pair<std::string, std::string> answer;
  interruptibly([&] {
    const auto estimators = command::measure_estimators(estimator, c.space.degrees());
    const command::Measurement result = command::measure_samples(c, std::move(samples), estimators);
    answer = {command::measurement_json(c, result), command::measurement_table(c, result)};
  });
  return answer;
}

// The exception
// --------------------------------------------------------------------------------------------------------------

PyObject* error_type = nullptr;  // lives as long as the interpreter

void raise(const Error& error) {
  std::vector<std::string> messages = {error.what()};
  if (const auto* mistakes = dynamic_cast<const trellis::lua::Mistakes*>(&error)) messages = mistakes->messages();
  if (const auto* errors = dynamic_cast<const trellis::Errors*>(&error)) messages = errors->messages();
  const auto value = py::reinterpret_borrow<py::object>(error_type)(error.what());
  value.attr("messages") = messages;
  PyErr_SetObject(error_type, value.ptr());
}

}  // namespace

PYBIND11_MODULE(_trellis, m) {
  m.doc() = "The native part of the package trellis. Call the functions of the package instead.";

  error_type = PyErr_NewExceptionWithDoc(
      "trellis.Error", "What Trellis reports of an input: a script, a problem, samples. `messages` has one each fault.",
      PyExc_Exception, nullptr);
  if (error_type == nullptr) throw py::error_already_set();
  m.add_object("Error", error_type);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& error) {
      raise(error);
    } catch (const Interrupted&) {
      // A thread that ends with SystemExit prints nothing.
      PyErr_SetNone(Call::is_exiting() ? PyExc_SystemExit : PyExc_KeyboardInterrupt);
    }
  });

  py::module_::import("atexit").attr("register")(py::cpp_function([] {
    const py::gil_scoped_release released;
    Call::exit();
  }));

  m.def("version", &trellis::version);
  m.def("commit", &command::commit);

  py::class_<StrategySpec>(m, "Strategy", "A hierarchy of guiding spaces with a planner. Immutable.")
      .def("__str__", &StrategySpec::text)
      .def("__repr__", [](const StrategySpec& spec) { return "<trellis.Strategy " + spec.text() + ">"; })
      .def(
          "__eq__", [](const StrategySpec& a, const StrategySpec& b) { return a == b; }, py::is_operator())
      .def("__hash__", [](const StrategySpec& spec) { return std::hash<std::string>()(spec.text()); });

  py::class_<GuideSpec>(m, "Guide", "A guide, or a hierarchy or combination of guides. Immutable.")
      .def("__str__", &GuideSpec::text)
      .def("__repr__", [](const GuideSpec& spec) { return "<trellis.Guide " + spec.text() + ">"; })
      .def(
          "__eq__", [](const GuideSpec& a, const GuideSpec& b) { return a == b; }, py::is_operator())
      .def("__hash__", [](const GuideSpec& spec) { return std::hash<std::string>()(spec.text()); });

  py::class_<CheckedProblem, std::shared_ptr<CheckedProblem>>(m, "Problem", py::dynamic_attr(),
                                                              "A world, a robot, a start and goals.")
      .def_property_readonly("name", [](const CheckedProblem& p) { return p.problem().name; })
      .def_property_readonly("names", [](const CheckedProblem& p) { return of_axes(p, &trellis::Axis::name); })
      .def_property_readonly("lo", [](const CheckedProblem& p) { return of_axes(p, &trellis::Axis::lo); })
      .def_property_readonly("hi", [](const CheckedProblem& p) { return of_axes(p, &trellis::Axis::hi); })
      .def_property_readonly("weights", [](const CheckedProblem& p) { return of_axes(p, &trellis::Axis::weight); })
      .def_property_readonly("periodic", [](const CheckedProblem& p) { return of_axes(p, &trellis::Axis::periodic); })
      .def_property_readonly("rotations", &rotations_of)
      .def_property_readonly("start", [](const CheckedProblem& p) { return p.problem().start; })
      .def_property_readonly("goals", [](const CheckedProblem& p) { return p.problem().goals; })
      .def("valid", &valid, py::arg("q"))
      .def("fault", &CheckedProblem::fault, py::arg("q"))
      .def("joints", &joints)
      .def("ik", &ik, py::arg("link"), py::arg("position"), py::arg("rpy") = py::none(),
           py::arg("quaternion") = py::none(), py::arg("within") = std::pair(1e-3, 1e-2),
           py::arg("seed") = std::uint64_t{0}, py::arg("count") = std::size_t{10})
      .def("__repr__", [](const CheckedProblem& p) { return "<trellis.Problem '" + p.problem().name + "'>"; });

  py::class_<Script, std::shared_ptr<Script>>(m, "Script", "What a script returns: strategies, problems, seeds.")
      .def_readonly("path", &Script::path)
      .def_property_readonly("strategies", &named_strategies)
      .def_property_readonly("problems", &named_problems)
      .def_property_readonly("seeds", [](const Script& s) { return s.program.experiment.seeds; })
      .def_property_readonly("measured", [](const Script& s) { return s.program.experiment.measure.has_value(); })
      .def_property_readonly("warnings", [](const Script& s) { return s.program.warnings; })
      .def("run",
           [](const py::object& script, const py::args& given, const py::kwargs& named) {
             return py::module_::import("trellis").attr("run")(script, *given, **named);
           })
      .def("__repr__", [](const Script& s) { return "<trellis.Script '" + s.path + "'>"; });

  m.def("load", &load, py::arg("path"), py::arg("trust"), py::arg("seed"));
  m.def("load_text", &load_text, py::arg("text"), py::arg("folder"), py::arg("trust"), py::arg("seed"));
  m.def("strategy", &strategy, py::arg("text"), py::arg("folder"));
  m.def("guide", &guide, py::arg("text"), py::arg("folder"));
  m.def(
      "problems",
      [](const std::string& text, const std::string& folder) {
        std::vector<std::shared_ptr<CheckedProblem>> found;
        for (Problem& problem : problems(text, folder)) {
          found.push_back(std::make_shared<CheckedProblem>(std::move(problem)));
        }
        return found;
      },
      py::arg("text"), py::arg("folder"));
  m.def(
      "run",
      [](std::shared_ptr<Script> script, std::vector<std::pair<std::string, StrategySpec>> strategies,
         std::vector<std::shared_ptr<CheckedProblem>> problems_, std::vector<std::uint64_t> seeds,
         const std::optional<std::string>& baseline, bool measured, unsigned jobs, unsigned threads,
         std::optional<double> ablation, std::optional<std::int64_t> cross, const std::optional<std::string>& samples,
         const std::optional<std::function<void(std::size_t, std::size_t)>>& progress) {
        const Request request{std::move(script), std::move(strategies), std::move(problems_), std::move(seeds)};
        return run(request, baseline, measured, jobs, threads, ablation, cross, samples, progress);
      },
      py::arg("script").none(true), py::arg("strategies"), py::arg("problems"), py::arg("seeds"), py::arg("baseline"),
      py::arg("measured"), py::arg("jobs"), py::arg("threads"), py::arg("ablation"), py::arg("cross"),
      py::arg("samples"), py::arg("progress"));
  add_function_guides(m);
  PythonSampler::add_to(m);
  m.def("sampler", [](const GuideSpec& of, const CheckedProblem& problem, std::uint64_t seed, double step,
                      double uniform, double goal_bias, double grant, bool optimistic) {
    return std::make_unique<PythonSampler>(
        of, problem.problem(), seed,
        trellis::SamplerOptions{
            .step = step, .uniform = uniform, .goal_bias = goal_bias, .grant = grant, .optimistic = optimistic});
  });
  m.def("measure", &measure, py::arg("case"), py::arg("folder"), py::arg("samples"), py::arg("estimator"),
        py::arg("valid"));
  m.def("named", [](const CheckedProblem& problem, std::string name) {
    Problem renamed = problem.problem();
    renamed.name = std::move(name);
    return std::make_shared<CheckedProblem>(std::move(renamed));
  });
  add_language(m, language_place());
}
