// SPDX-License-Identifier: GPL-3.0-or-later
// The distribution of the next proposal, from what a guidance records.
#pragma once

#include <trellis/planner/guidance.hpp>

namespace trellis::test {

/// The record of one proposal of h: `at` is the density, `atoms` the mass of its atoms.
inline DensityRecord record_of(const Guidance& h) {
  DensityRecord record;
  record.served(h);
  return record;
}

}  // namespace trellis::test
