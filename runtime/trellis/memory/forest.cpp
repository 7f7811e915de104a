// SPDX-License-Identifier: GPL-3.0-or-later
// The only source that includes dlib.
#include <trellis/memory/forest.hpp>

#include <dlib/random_forest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>
#include <vector>

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

using Extractor = Function::feature_extractor_type;
using Node = dlib::internal_tree_node<Extractor>;

/// Reads lists of lists as dlib writes them, and takes no more memory than the bytes can fill.
template <class Element>
std::vector<std::vector<Element>> lists(std::istream& in, std::size_t bytes) {
  const auto count = [&] {
    unsigned long size = 0;
    dlib::deserialize(size, in);
    if (size > bytes) throw Error("the forest is longer than its file");
    return size;
  };
  std::vector<std::vector<Element>> all(count());
  std::size_t elements = 0;
  for (std::vector<Element>& list : all) {
    list.resize(count());
    elements += list.size();
    if (elements > bytes) throw Error("the forest is longer than its file");
    for (Element& element : list) dlib::deserialize(element, in);
  }
  return all;
}

/// Whether every branch of a tree ends at one of its leaves: dlib follows the numbers of nodes without a check.
bool is_tree(const std::vector<Node>& nodes, const std::vector<float>& leaves, std::size_t columns) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Node& node = nodes[i];
    if (node.split_feature >= columns || std::isnan(node.split_threshold)) return false;
    for (const std::size_t next : {std::size_t{node.left}, std::size_t{node.right}}) {
      if (next <= i || next >= nodes.size() + leaves.size()) return false;
    }
  }
  return !leaves.empty() && std::all_of(leaves.begin(), leaves.end(), [](float x) { return std::isfinite(x); });
}

/// \throws Error, and what dlib throws.
Function read_function(const std::string& bytes, std::size_t columns) {
  Extractor extractor;
  extractor.setup(std::vector<Row>{Row(static_cast<long>(columns))}, std::vector<double>{0.0});
  std::ostringstream head;
  dlib::serialize("random_forest_regression_function", head);
  serialize(extractor, head);
  // Compared and not read: dlib would take as much memory for a name as the bytes ask for.
  if (!bytes.starts_with(head.str())) throw Error("the forest is of other features, or none");
  std::istringstream in(bytes.substr(head.str().size()));
  auto trees = lists<Node>(in, bytes.size());
  auto leaves = lists<float>(in, bytes.size());
  bool sound = !trees.empty() && trees.size() == leaves.size();
  for (std::size_t i = 0; sound && i < trees.size(); ++i) sound = is_tree(trees[i], leaves[i], columns);
  if (!sound) throw Error("the forest has branches that end at no leaf");
  return {Extractor(extractor), std::move(trees), std::move(leaves)};
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
  try {
    return Forest(std::make_unique<const Trees>(Trees{read_function(bytes, columns)}));
  } catch (const Error&) {
    throw;
  } catch (const std::exception&) {
    throw Error("the forest cannot be read");
  }
}

std::string Forest::bytes() const {
  std::ostringstream out;
  serialize(trees_->function, out);
  return out.str();
}

double Forest::operator()(std::span<const double> row) const { return trees_->function(row_of(row)); }

}  // namespace trellis
