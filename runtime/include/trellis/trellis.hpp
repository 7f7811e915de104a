// SPDX-License-Identifier: GPL-3.0-or-later
// Problems, strategies, their execution, and samplers. Tests include <trellis/testing.hpp>, users of Eigen
// <trellis/eigen.hpp>, users of OMPL <trellis/ompl.hpp>.
//
//     const StrategySpec strategy = GuideSpec::make("skeleton", {}) >> StrategySpec(PlannerSpec::make("rrt", {}));
//     for (const Problem& problem : read_problems("scene.txt", {})) {
//       const RunRecord run = execute(strategy, problem, seed);
//     }
#pragma once

#include <trellis/base/error.hpp>
#include <trellis/base/version.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/scene/planar/scene.hpp>
#include <trellis/scene/spatial/point_cloud.hpp>
#include <trellis/scene/spatial/scene.hpp>
#include <trellis/strategy/executor.hpp>
#include <trellis/strategy/sampler.hpp>
#include <trellis/strategy/spec.hpp>
