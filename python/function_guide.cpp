// SPDX-License-Identifier: MIT-0
// Guides with S = {0} whose h is a function in Python; `trellis.guide` is what users call.
#include "function_guide.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/base/slice_monitor.hpp>
#include <trellis/guide/custom.hpp>
#include <trellis/instance/search_cost.hpp>
#include <trellis/strategy/spec.hpp>

#include "call.hpp"

namespace py = pybind11;

using namespace trellis;

namespace {

using Rows = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// A function in Python, which any thread may release.
class Function {
 public:
  Function(py::object callable, std::string name, double cost)
      : name_(std::move(name)), cost_(cost), callable_(std::move(callable)) {}
  ~Function() {
    if (Call::is_exiting()) {
      static_cast<void>(callable_.release());
      return;
    }
    const py::gil_scoped_acquire held;
    callable_ = py::object();
  }
  Function(const Function&) = delete;
  Function& operator=(const Function&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] double cost() const { return cost_; }
  /// Requires the GIL.
  [[nodiscard]] const py::object& callable() const { return callable_; }

 private:
  std::string name_;
  double cost_;  ///< of one call, seconds
  py::object callable_;
};

/// What is known about C: proposals and their results, row by row.
struct Log {
  std::vector<double> q, node, blocked_at;
  std::vector<std::int8_t> fate;
  std::vector<std::uint8_t> mine;

  void add(const Outcome& outcome, bool of_this, std::size_t dimension) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    const auto push = [&](std::vector<double>& rows, View at) {
      if (at.empty()) {
        rows.insert(rows.end(), dimension, none);
      } else {
        rows.insert(rows.end(), at.begin(), at.end());
      }
    };
    push(q, outcome.proposal);
    push(node, outcome.added);
    push(blocked_at, outcome.blocked_at);
    fate.push_back(static_cast<std::int8_t>(outcome.fate));
    mine.push_back(of_this ? 1 : 0);
  }
};

/// The argument of the function, valid during its call.
class KnownArrays {
 public:
  KnownArrays(const Log& log, Instance& instance, std::size_t count, std::uint64_t seed)
      : log_(&log), instance_(&instance), count_(count), seed_(seed) {}

  void end() { instance_ = nullptr; }
  [[nodiscard]] const Instance& instance() const { return *checked(); }
  [[nodiscard]] const Log& log() const {
    static_cast<void>(checked());
    reads_ = true;
    return *log_;
  }
  /// Whether the function has read of the log.
  [[nodiscard]] bool reads() const { return reads_; }
  [[nodiscard]] std::size_t count() const { return count_; }
  /// The generator of the call, made at its first use.
  py::object rng() {
    if (!rng_) rng_ = py::module_::import("numpy.random").attr("default_rng")(seed_);
    return rng_;
  }
  py::array_t<bool> valid(const Rows& rows) {
    Instance& instance = *checked();
    const auto dimension = static_cast<py::ssize_t>(instance.space.dimension());
    if (rows.ndim() != 2 || rows.shape(1) != dimension) {
      throw Error("known.valid takes an array of shape (N, " + std::to_string(dimension) + ")");
    }
    py::array_t<bool> answers(rows.shape(0));
    Configuration q;
    for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
      const double* row = rows.data(i, 0);
      q.assign(row, row + dimension);
      answers.mutable_at(i) = instance.space.contains(q) && instance.valid(q);
    }
    return answers;
  }

 private:
  [[nodiscard]] Instance* checked() const {
    if (instance_ == nullptr)
      throw Error("`known` is valid during the call of the guide's function alone: copy what is kept");
    return instance_;
  }

  const Log* log_;
  Instance* instance_;
  std::size_t count_;
  std::uint64_t seed_;
  mutable bool reads_ = false;
  py::object rng_;
};

py::array_t<double> rows_of(const std::vector<double>& values, std::size_t dimension) {
  const auto d = static_cast<py::ssize_t>(dimension);
  py::array_t<double> rows({static_cast<py::ssize_t>(values.size()) / d, d});
  std::copy(values.begin(), values.end(), rows.mutable_data());
  return rows;
}

/// "ValueError: no rows (own.py, line 7)". Requires the GIL.
std::string text_of(py::error_already_set& error) {
  const py::object value = error.value();
  std::string text = py::str(py::type::of(value).attr("__name__"));
  const std::string what = py::str(value);
  if (!what.empty()) text += ": " + what;
  if (!error.trace()) return text;
  const py::list frames = py::module_::import("traceback").attr("extract_tb")(error.trace());
  if (frames.empty()) return text;
  const py::object last = frames[frames.size() - 1];
  return text + " (" + std::string(py::str(last.attr("filename"))) + ", line " +
         std::string(py::str(last.attr("lineno"))) + ")";
}

/// h: draws the rows of a batch that the function returned. Batches double from 8 to 512. Where the function has read
/// what became of proposals, they begin anew with 8 when a node was added.
class FunctionHeuristic final : public Heuristic {
 public:
  FunctionHeuristic(std::shared_ptr<const Function> function, Instance& parent)
      : function_(std::move(function)), parent_(parent), batch_(parent.space.dimension()) {}

  Source sample(Stream& stream, MutableView out) override {
    if (next_ == batch_.size()) refill(stream.bits());
    const View row = std::as_const(batch_)[next_++];
    std::copy(row.begin(), row.end(), out.begin());
    return 0;
  }
  void observe(const Outcome& outcome, bool mine) override {
    log_.add(outcome, mine, parent_.space.dimension());
    if (!reads_ || outcome.added.empty()) return;
    batch_.clear();
    next_ = 0;
    size_ = least;
  }
  [[nodiscard]] std::vector<std::string> sources() const override { return {function_->name()}; }

 private:
  static constexpr std::size_t least = 8;
  static constexpr std::size_t most = 512;

  void refill(std::uint64_t seed) {
    constexpr double unit = 0.07e-6;  // seconds
    parent_.spend(function_->cost() / unit);
    const std::string name = "guide '" + function_->name() + "': ";
    batch_.clear();
    next_ = 0;
    const py::gil_scoped_acquire held;
    const py::object known = py::cast(KnownArrays(log_, parent_, size_, seed));
    try {
      // An exception by which bounded loss ends a search would pass through Python: its checks are counted after it.
      const py::object answer = [&] {
        const MonitorScope unmonitored(nullptr);
        return function_->callable()(known);
      }();
      reads_ = known.cast<KnownArrays&>().reads();
      known.cast<KnownArrays&>().end();
      const auto rows = Rows::ensure(answer);
      const auto dimension = static_cast<py::ssize_t>(parent_.space.dimension());
      if (!rows) PyErr_Clear();
      if (!rows || rows.ndim() != 2 || rows.shape(1) != dimension || rows.shape(0) == 0) {
        throw Error(name + "it returns an array of shape (N, " + std::to_string(dimension) + "), N at least 1; got " +
                    (py::hasattr(answer, "shape") ? std::string("shape ") + std::string(py::str(answer.attr("shape")))
                                                  : std::string(py::str(py::type::of(answer).attr("__name__")))));
      }
      Configuration q;
      for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
        const double* row = rows.data(i, 0);
        q.assign(row, row + dimension);
        if (!std::all_of(q.begin(), q.end(), [](double x) { return std::isfinite(x); })) {
          throw Error(name + "row " + std::to_string(i + 1) + " has a coordinate that is not finite");
        }
        parent_.space.reflect(q);
        batch_.push(q);
      }
    } catch (py::error_already_set& error) {
      known.cast<KnownArrays&>().end();
      if (Call::is_exiting()) throw;
      throw Error(name + text_of(error));
    }
    size_ = std::min(most, 2 * size_);
  }

  std::shared_ptr<const Function> function_;
  Instance& parent_;
  Log log_;
  Configurations batch_;
  std::size_t next_ = 0;
  std::size_t size_ = least;
  bool reads_ = false;  ///< the last batch depends on the log
};

class FunctionGuide final : public SamplingGuide {
 public:
  explicit FunctionGuide(std::shared_ptr<const Function> function) : function_(std::move(function)) {}
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance* sub, const Solution* found) override {
    static_cast<void>(sub);
    static_cast<void>(found);
    return std::make_unique<FunctionHeuristic>(function_, parent);
  }

 private:
  std::shared_ptr<const Function> function_;
};

class CustomFunction final : public CustomGuide {
 public:
  CustomFunction(Description description, std::shared_ptr<const Function> function)
      : CustomGuide(std::move(description)), function_(std::move(function)) {}
  [[nodiscard]] std::unique_ptr<Guide> make(const GuideSite& site) const override {
    static_cast<void>(site);
    return std::make_unique<FunctionGuide>(function_);
  }

 private:
  std::shared_ptr<const Function> function_;
};

GuideSpec function_guide(const py::object& callable, const std::string& name, const std::string& identity,
                         const std::string& summary, double cost) {
  GuideClaims claims;
  claims.h = summary;
  claims.feedback = "each result; new draws where a node was added, if the function has read results";
  return GuideSpec::make(std::make_shared<CustomFunction>(
      CustomGuide::Description{
          .name = name, .identity = identity, .default_planner = "", .resolves = 0, .claims = std::move(claims)},
      std::make_shared<const Function>(callable, name, cost)));
}

}  // namespace

void add_function_guides(py::module_& module) {
  const auto dimension = [](const KnownArrays& known) { return known.instance().space.dimension(); };
  const auto of_axes = [](const KnownArrays& known, auto member) {
    std::vector<double> values;
    for (const Axis& axis : known.instance().space.coordinates()) values.push_back(static_cast<double>(axis.*member));
    return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
  };
  py::class_<KnownArrays>(module, "Known", "What a guide's function receives; valid during its call.")
      .def_property_readonly("q", [=](const KnownArrays& known) { return rows_of(known.log().q, dimension(known)); })
      .def_property_readonly("node",
                             [=](const KnownArrays& known) { return rows_of(known.log().node, dimension(known)); })
      .def_property_readonly(
          "blocked_at", [=](const KnownArrays& known) { return rows_of(known.log().blocked_at, dimension(known)); })
      .def_property_readonly("fate",
                             [](const KnownArrays& known) {
                               const auto& fate = known.log().fate;
                               return py::array_t<std::int8_t>(static_cast<py::ssize_t>(fate.size()), fate.data());
                             })
      .def_property_readonly("mine",
                             [](const KnownArrays& known) {
                               const auto& mine = known.log().mine;
                               py::array_t<bool> flags(static_cast<py::ssize_t>(mine.size()));
                               std::copy(mine.begin(), mine.end(), flags.mutable_data());
                               return flags;
                             })
      .def_property_readonly("start",
                             [](const KnownArrays& known) {
                               const Configuration& q = known.instance().start;
                               return py::array_t<double>(static_cast<py::ssize_t>(q.size()), q.data());
                             })
      .def_property_readonly("goals",
                             [=](const KnownArrays& known) {
                               std::vector<double> all;
                               for (const Configuration& q : known.instance().goals)
                                 all.insert(all.end(), q.begin(), q.end());
                               return rows_of(all, dimension(known));
                             })
      .def_property_readonly("names",
                             [](const KnownArrays& known) {
                               std::vector<std::string> names;
                               for (const Axis& axis : known.instance().space.coordinates()) names.push_back(axis.name);
                               return names;
                             })
      .def_property_readonly("lo", [=](const KnownArrays& known) { return of_axes(known, &Axis::lo); })
      .def_property_readonly("hi", [=](const KnownArrays& known) { return of_axes(known, &Axis::hi); })
      .def_property_readonly("weights", [=](const KnownArrays& known) { return of_axes(known, &Axis::weight); })
      .def_property_readonly("count", &KnownArrays::count)
      .def_property_readonly("rng", &KnownArrays::rng)
      .def("valid", &KnownArrays::valid);
  module.def("function_guide", &function_guide);
}
