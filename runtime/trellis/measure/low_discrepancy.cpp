// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/low_discrepancy.hpp>

#include <boost/random/sobol.hpp>
#include <utility>

namespace trellis::measure {

struct LowDiscrepancy::Engine {
  explicit Engine(std::size_t dimension) : sobol(dimension) {}
  boost::random::sobol sobol;
};

LowDiscrepancy::LowDiscrepancy(std::size_t dimension, std::vector<double> shift)
    : engine_(std::make_unique<Engine>(dimension)), shift_(std::move(shift)) {}

LowDiscrepancy::~LowDiscrepancy() = default;

void LowDiscrepancy::next(MutableView point) {
  for (std::size_t j = 0; j < point.size(); ++j) {
    const double u = static_cast<double>(engine_->sobol() >> 11U) * 0x1.0p-53 + shift_[j];
    point[j] = u < 1.0 ? u : u - 1.0;
  }
}

}  // namespace trellis::measure
