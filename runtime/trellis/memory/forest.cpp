// SPDX-License-Identifier: GPL-3.0-or-later
// The only source that includes dlib.
#include <trellis/memory/forest.hpp>

#include <dlib/random_forest.h>

#include <algorithm>
#include <sstream>
#include <utility>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

using Function = dlib::random_forest_regression_function<>;
using Row = Function::sample_type;

Row row_of(std::span<const double> numbers) {
  Row row(static_cast<long>(numbers.size()));
  std::copy(numbers.begin(), numbers.end(), row.begin());
  return row;
}

}  // namespace

struct Forest::Trees {
  Function function;
};

Forest::Forest(std::unique_ptr<const Trees> trees) : trees_(std::move(trees)) {}
Forest::~Forest() = default;
Forest::Forest(Forest&&) noexcept = default;
Forest& Forest::operator=(Forest&&) noexcept = default;

Forest Forest::train(const std::vector<double>& rows, std::size_t columns, const std::vector<double>& values,
                     const ForestSettings& settings) {
  if (values.empty() || rows.size() != values.size() * columns) throw Fault("a forest needs a row for each value");
  std::vector<Row> samples;
  samples.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    samples.push_back(row_of(std::span(rows).subspan(i * columns, columns)));
  }
  dlib::random_forest_regression_trainer<> trainer;
  trainer.set_num_trees(settings.trees);
  trainer.set_min_samples_per_leaf(settings.leaf);
  trainer.set_seed(std::to_string(settings.seed));
  return Forest(std::make_unique<const Trees>(Trees{trainer.train(samples, values)}));
}

Forest Forest::from_bytes(const std::string& bytes, std::size_t columns) {
  std::istringstream in(bytes);
  auto trees = std::make_unique<Trees>();
  try {
    deserialize(trees->function, in);
  } catch (const std::exception&) {
    throw Error("the forest cannot be read");
  }
  if (trees->function.get_num_trees() == 0 || trees->function.get_feature_extractor().max_num_feats() != columns) {
    throw Error("the forest is of other features");
  }
  return Forest(std::move(trees));
}

std::string Forest::bytes() const {
  std::ostringstream out;
  serialize(trees_->function, out);
  return out.str();
}

double Forest::operator()(std::span<const double> row) const { return trees_->function(row_of(row)); }

}  // namespace trellis
