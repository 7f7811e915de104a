// SPDX-License-Identifier: GPL-3.0-or-later
// The part that bench_se3 and the OMPL peer of SE(3) share: a problem as both sides read it from one file, so that both
// have the same meshes; the command line, and the lines of results. Includes neither library.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iomanip>
#include <stdexcept>
#include <string>
#include <vector>

#include "rrt_bench.hpp"

namespace bench {

struct Triangles {
  std::vector<std::array<double, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// A rigid body among obstacles, both surfaces of triangles. Poses are x, y, z and a quaternion x, y, z, w.
struct Body {
  std::string name;
  std::array<double, 6> bounds{};  ///< xmin, ymin, zmin, xmax, ymax, zmax
  bool whole = false;              ///< whether the whole robot must lie inside the bounds, else its reference point
  double weight = 0.0;             ///< metres per radian in the metric
  double radius = 0.0;             ///< of the robot about its reference point
  double resolution = 0.0;
  double step = 0.0;
  std::array<double, 7> start{};
  std::array<double, 7> goal{};
  Triangles robot;
  Triangles obstacles;
};

inline void write(std::ostream& out, const Triangles& mesh) {
  out << mesh.vertices.size() << ' ' << mesh.triangles.size() << '\n';
  for (const auto& v : mesh.vertices) out << v[0] << ' ' << v[1] << ' ' << v[2] << '\n';
  for (const auto& t : mesh.triangles) out << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
}

inline void write(const std::string& path, const Body& body) {
  std::ofstream out(path);
  out << std::setprecision(17) << body.name << '\n';
  for (const double x : body.bounds) out << x << ' ';
  out << '\n' << body.whole << ' ' << body.weight << ' ' << body.radius << ' ' << body.resolution << ' ' << body.step;
  out << '\n';
  for (const double x : body.start) out << x << ' ';
  out << '\n';
  for (const double x : body.goal) out << x << ' ';
  out << '\n';
  write(out, body.robot);
  write(out, body.obstacles);
  if (!out.flush()) throw std::runtime_error("cannot write " + path);
}

inline void read(std::istream& in, Triangles& mesh) {
  std::size_t vertices = 0, triangles = 0;
  in >> vertices >> triangles;
  mesh.vertices.resize(vertices);
  mesh.triangles.resize(triangles);
  for (auto& v : mesh.vertices) in >> v[0] >> v[1] >> v[2];
  for (auto& t : mesh.triangles) in >> t[0] >> t[1] >> t[2];
}

inline Body read(const std::string& path) {
  std::ifstream in(path);
  Body body;
  in >> body.name;
  for (double& x : body.bounds) in >> x;
  in >> body.whole >> body.weight >> body.radius >> body.resolution >> body.step;
  for (double& x : body.start) in >> x;
  for (double& x : body.goal) in >> x;
  read(in, body.robot);
  read(in, body.obstacles);
  if (!in) throw std::runtime_error("cannot read " + path);
  return body;
}

struct BodyArguments {
  std::string file;
  std::string checker;
  std::uint64_t seeds = 20;
};

/// Reads FILE CHECKER SEEDS. Throws std::invalid_argument.
inline BodyArguments parse_body(int argc, char** argv) {
  if (argc != 4) throw std::invalid_argument("usage: FILE CHECKER SEEDS");
  BodyArguments arguments{argv[1], argv[2], std::strtoull(argv[3], nullptr, 10)};
  if (arguments.seeds == 0) throw std::invalid_argument("SEEDS must be a positive integer");
  return arguments;
}

/// Runs `plan` for every seed and prints its lines, as `measure` does.
inline void measure(const BodyArguments& arguments, const std::string& side, const std::string& scene,
                    const std::function<Run(std::uint64_t seed)>& plan) {
  for (std::uint64_t seed = 1; seed <= arguments.seeds; ++seed) {
    const Run run = plan(seed);
    std::printf("RUN\t%s\t%s\t%s\t%" PRIu64 "\t%d\t%.9f\t%.9f\t%" PRIu64 "\t%" PRIu64 "\t%" PRIu64 "\n", side.c_str(),
                arguments.checker.c_str(), scene.c_str(), seed, run.solved ? 1 : 0, run.cpu, run.planning,
                run.iterations, run.checks, run.nodes);
    std::fflush(stdout);
  }
}

}  // namespace bench
