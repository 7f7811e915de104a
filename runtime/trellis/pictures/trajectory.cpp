// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/pictures/trajectory.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/results/csv.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>

namespace trellis {

namespace {

/// Seconds between two samples, at most.
constexpr double spacing = 0.05;

std::vector<std::string> names_of(const Space& space) {
  std::vector<std::string> names;
  for (const Axis& axis : space.coordinates()) names.push_back(axis.name);
  return names;
}

/// A string of YAML, in double quotes.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < ' ') {
      out += fmt::format("\\x{:02x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      out += c;
    }
  }
  return out + '"';
}

/// A number that YAML reads as one with a decimal point; never "-0".
std::string decimal(double x) {
  const std::string text = fmt::format("{:.9f}", x == 0.0 ? 0.0 : x);
  return text == "-0.000000000" ? "0.000000000" : text;
}

std::string numbers_text(const std::vector<double>& numbers) {
  std::string text;
  for (const double x : numbers) text += (text.empty() ? "" : ", ") + decimal(x);
  return "[" + text + "]";
}

/// The lines at the beginning of a file, each after "# ".
std::string comment(const TimedRun& timed) {
  const RunResult& run = *timed.run;
  const auto plain = [](std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
    return text;
  };
  return fmt::format(
      "# problem {}, strategy {}, seed {}: {:.6g} s, {} straight leg{} in the space of the joints\n"
      "# The motion follows the path of the run and stops wherever the path bends. On each leg all joints start, "
      "keep their speeds and stop together.\n"
      "# Speeds: limits of the URDF file, else {:g} rad/s or m/s; accelerations: {:g} rad/s^2 or m/s^2.\n"
      "# Cubic splines through positions and velocities give it exactly. A joint without limits is continued beyond "
      "pi, so that it never jumps.\n",
      plain(run.problem), plain(run.strategy), run.seed, timed.path.duration(), timed.path.legs(),
      timed.path.legs() == 1 ? "" : "s", timed.settings.velocity, timed.settings.acceleration);
}

std::string yaml(const TimedRun& timed) {
  std::string names;
  for (const std::string& name : names_of(timed.problem->space)) names += (names.empty() ? "" : ", ") + quoted(name);
  std::string text = comment(timed) + "header:\n  stamp: {sec: 0, nanosec: 0}\n  frame_id: \"\"\njoint_names: [" +
                     names + "]\npoints:\n";
  for (const TimedPath::Sample& sample : timed.path.samples(spacing)) {
    constexpr double nano = 1e9;
    const auto nanoseconds = static_cast<std::int64_t>(std::llround(sample.time * nano));
    constexpr std::int64_t second = 1'000'000'000;
    text += fmt::format("  - positions: {}\n    velocities: {}\n    time_from_start: {{sec: {}, nanosec: {}}}\n",
                        numbers_text(sample.position), numbers_text(sample.velocity), nanoseconds / second,
                        nanoseconds % second);
  }
  return text;
}

std::string csv(const TimedRun& timed) {
  const std::vector<std::string> names = names_of(timed.problem->space);
  std::string text = "time";
  for (const std::string& name : names) text += "," + csv_text(name);
  for (const std::string& name : names) text += "," + csv_text(name + " velocity");
  text += "\n";
  for (const TimedPath::Sample& sample : timed.path.samples(spacing)) {
    text += decimal(sample.time);
    for (const double x : sample.position) text += "," + decimal(x);
    for (const double x : sample.velocity) text += "," + decimal(x);
    text += "\n";
  }
  return text;
}

}  // namespace

RateLimits rate_limits(const Scene& scene, const Space& space, const TrajectorySettings& settings) {
  const std::size_t n = space.dimension();
  RateLimits limits{std::vector<double>(n, settings.velocity), std::vector<double>(n, settings.acceleration)};
  const ManipulatorScene* manipulator = scene.manipulator();
  if (manipulator == nullptr) return limits;
  const std::vector<Axis> axes = space.coordinates();
  const std::vector<Joint>& joints = manipulator->robot.robot().tree().joints();
  for (std::size_t j = 0; j < n; ++j) {
    const auto joint =
        std::find_if(joints.begin(), joints.end(), [&](const Joint& one) { return one.name == axes[j].name; });
    if (joint == joints.end()) continue;
    if (joint->velocity > 0.0) limits.velocity[j] = joint->velocity;
    const auto number = static_cast<std::size_t>(joint - joints.begin());
    for (const Joint& other : joints) {
      if (!other.mimic || other.mimic->joint != number || !(other.velocity > 0.0)) continue;
      const double times = std::abs(other.mimic->multiplier);
      if (times > 0.0) limits.velocity[j] = std::min(limits.velocity[j], other.velocity / times);
    }
  }
  return limits;
}

TimedRun timed_run(const Experiment& experiment, const ExperimentResult& result, const TrajectorySettings& settings) {
  for (const Problem& problem : experiment.problems) {
    for (const auto& entry : experiment.strategies) {
      for (const RunResult* run : select_runs(result, problem.name, entry.first)) {
        if (!run->run.solved || run->run.path.empty()) continue;
        if (problem.motion_model) {
          throw Error(fmt::format("no trajectory of problem '{}': its motion model {} has times of its own",
                                  problem.name, problem.motion_model->text()));
        }
        if (!problem.space.flat()) {
          throw Error(
              fmt::format("no trajectory of problem '{}': the robot '{}' turns freely in space, and a "
                          "trajectory is one of joints",
                          problem.name, problem.scene->robot_name()));
        }
        return {&problem, run,
                TimedPath(problem.space, run->run.path, rate_limits(*problem.scene, problem.space, settings)),
                settings};
      }
    }
  }
  throw Error("no trajectory: no run found a path");
}

TrajectoryForm trajectory_form(const std::string& file) {
  const std::string ending = std::filesystem::path(file).extension().string();
  if (ending == ".yaml" || ending == ".yml") return TrajectoryForm::yaml;
  if (ending == ".csv") return TrajectoryForm::csv;
  throw Error(fmt::format("a trajectory's name ends with .yaml (JointTrajectory of ROS) or .csv, got '{}'", file));
}

std::string trajectory_text(const TimedRun& run, TrajectoryForm form) {
  return form == TrajectoryForm::yaml ? yaml(run) : csv(run);
}

}  // namespace trellis
