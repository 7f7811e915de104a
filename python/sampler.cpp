// SPDX-License-Identifier: MIT-0
// trellis._trellis.Sampler; python/trellis/_sampler.py is what users call.
#include "sampler.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <trellis/base/error.hpp>

#include "call.hpp"

namespace py = pybind11;

using trellis::Configurations;
using trellis::Error;
using trellis::Side;
using trellis::View;

namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

Side side_of(const std::string& name) {
  if (name == "start") return Side::start;
  if (name == "goal") return Side::goal;
  throw Error("sampler: a side is \"start\" or \"goal\", got \"" + name + "\"");
}

/// A configuration; None: empty.
View view_of(const std::optional<Array>& array, const char* what) {
  if (!array) return {};
  if (array->ndim() != 1) throw Error(std::string("sampler: ") + what + " must be an array of numbers with one axis");
  return {array->data(), static_cast<std::size_t>(array->size())};
}

py::array_t<double> array_of(const Configurations& rows) {
  const auto n = static_cast<py::ssize_t>(rows.size());
  const auto d = static_cast<py::ssize_t>(rows.dimension());
  py::array_t<double> array({n, d});
  const auto& values = rows.values();
  std::copy(values.begin(), values.end(), array.mutable_data());
  return array;
}

const char* text_of(trellis::Found found) {
  switch (found) {
    case trellis::Found::untried: return "untried";
    case trellis::Found::searching: return "searching";
    case trellis::Found::found: return "found";
    case trellis::Found::nothing: return "nothing";
    case trellis::Found::impossible: return "impossible";
  }
  return "";
}

py::object number_or_none(std::uint32_t node) {
  return node == trellis::no_node ? py::object(py::none()) : py::object(py::int_(node));
}

py::dict level_of(const trellis::LevelRecord& level) {
  py::dict of;
  of["level"] = level.level;
  of["name"] = level.name;
  of["planner"] = level.planner;
  of["checks"] = level.search.checks.validity;
  of["solved"] = level.solution.solved();
  of["names"] = [&] {
    std::vector<std::string> names;
    for (const trellis::Axis& axis : level.space.coordinates()) names.push_back(axis.name);
    return names;
  }();
  of["proposals"] = array_of(level.search.proposals);
  of["nodes"] = array_of(level.search.nodes);
  std::vector<std::int64_t> parents;
  for (const std::uint32_t parent : level.search.parents) {
    parents.push_back(parent == trellis::no_node ? -1 : static_cast<std::int64_t>(parent));
  }
  of["parents"] = py::array_t<std::int64_t>(static_cast<py::ssize_t>(parents.size()), parents.data());
  of["path"] = level.solution.solved() ? py::object(array_of(level.solution.path)) : py::object(py::none());
  return of;
}

}  // namespace

/// Looks for signals from time to time, in the thread that draws.
struct PythonSampler::Signals {
  using Clock = std::chrono::steady_clock;

  bool stopped() {
    constexpr std::chrono::milliseconds interval(50);
    if (raised || Call::is_stopped()) return true;
    const auto now = Clock::now();
    if (now - looked < interval) return false;
    looked = now;
    const py::gil_scoped_acquire held;
    if (PyErr_CheckSignals() == 0) return false;
    raised.emplace();
    return true;
  }

  Clock::time_point looked = Clock::now();
  std::optional<py::error_already_set> raised;
};

PythonSampler::PythonSampler(const trellis::GuideSpec& guide, const trellis::Problem& problem, std::uint64_t seed,
                             trellis::SamplerOptions options)
    : signals_(std::make_shared<Signals>()), sampler_([&] {
        options.interrupted = [signals = signals_] { return signals->stopped(); };
        const Call running;
        const py::gil_scoped_release released;
        return trellis::Sampler(guide, problem, seed, options);
      }()) {}

template <class Body>
auto PythonSampler::released(const Body& body) {
  signals_->raised.reset();
  const Call running;
  try {
    const py::gil_scoped_release without;
    return body();
  } catch (const trellis::SamplerInterrupted&) {
    if (!signals_->raised) {
      PyErr_SetNone(Call::is_exiting() ? PyExc_SystemExit : PyExc_KeyboardInterrupt);
      throw py::error_already_set();
    }
    py::error_already_set raised = std::move(*signals_->raised);
    signals_->raised.reset();
    throw raised;
  }
}

void PythonSampler::add_to(py::module_& module) {
  using Self = PythonSampler;
  py::class_<Self>(module, "Sampler", "A guide that a planner in Python draws from.")
      .def("draw",
           [](Self& self, const std::string& side) {
             const Side of = side_of(side);
             py::array_t<double> q(static_cast<py::ssize_t>(self.sampler_.space().dimension()));
             const trellis::MutableView out(q.mutable_data(), static_cast<std::size_t>(q.size()));
             const trellis::Draw draw = self.released([&] { return self.sampler_.draw(out, of); });
             return py::make_tuple(draw.id, q, draw.guided, number_or_none(draw.node));
           })
      .def("draw_many",
           [](Self& self, std::size_t n, const std::string& side) {
             const Side of = side_of(side);
             return array_of(self.released([&] { return self.sampler_.draw_many(n, of); }));
           })
      .def("root", [](Self& self, const std::string& side,
                      std::size_t goal) { return self.sampler_.root(side_of(side), goal); })
      .def("node", [](Self& self, const Array& q) { return number_or_none(self.sampler_.node(view_of(q, "a node"))); })
      .def("nodes", [](const Self& self) { return self.sampler_.nodes(); })
      .def("accepted",
           [](Self& self, std::uint64_t id, const Array& q, std::optional<std::uint32_t> parent, bool reached,
              bool connected, const std::string& side) {
             return self.sampler_.accepted(id, view_of(q, "q"), parent.value_or(trellis::no_node), reached, connected,
                                           side_of(side));
           })
      .def("rejected",
           [](Self& self, std::uint64_t id, const std::optional<Array>& from, const std::optional<Array>& to,
              const std::optional<Array>& at) {
             self.sampler_.rejected(id, view_of(from, "start"), view_of(to, "end"), view_of(at, "at"));
           })
      .def("joined",
           [](Self& self, std::uint32_t node, const std::string& side) { self.sampler_.joined(node, side_of(side)); })
      .def("cleared", [](Self& self) { self.sampler_.cleared(); })
      .def("path_found", [](Self& self, double length) { self.sampler_.path_found(length); })
      .def("worth_connecting",
           [](Self& self, const Array& from, const Array& to) {
             return self.sampler_.worth_connecting(view_of(from, "start"), view_of(to, "end"));
           })
      .def("edge_factor", [](Self& self, const Array& a,
                             const Array& b) { return self.sampler_.edge_factor(view_of(a, "a"), view_of(b, "b")); })
      .def("spent", [](Self& self, std::uint64_t checks) { self.sampler_.spent(checks); })
      .def("allow",
           [](Self& self, std::uint64_t checks) {
             self.released([&] { return self.sampler_.allow(checks); });
             return text_of(self.sampler_.level());
           })
      .def("state", [](const Self& self) { return text_of(self.sampler_.level()); })
      .def("checks", [](const Self& self) { return self.sampler_.checks(); })
      .def("density",
           [](Self& self, const Array& rows) -> py::object {
             const auto dimension = static_cast<py::ssize_t>(self.sampler_.space().dimension());
             if (rows.ndim() != 2 || rows.shape(1) != dimension) {
               throw Error("sampler: configurations must be an array of shape (N, " + std::to_string(dimension) + ")");
             }
             py::array_t<double> values(rows.shape(0));
             for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
               const View q(rows.data(i, 0), static_cast<std::size_t>(dimension));
               const auto value = self.released([&] { return self.sampler_.density(q); });
               if (!value) return py::none();
               values.mutable_at(i) = *value;
             }
             return values;
           })
      .def("levels", [](Self& self) {
        py::list levels;
        for (const trellis::LevelRecord& level : self.sampler_.levels()) levels.append(level_of(level));
        return levels;
      });
}
