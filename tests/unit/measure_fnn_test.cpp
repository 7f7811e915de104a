// SPDX-License-Identifier: GPL-3.0-or-later
// Plain nearest neighbours against R's package FNN, an independent program; left out where it is not installed.
#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <trellis/measure/efficiency.hpp>

#include "support/catch.hpp"
#include "support/folder.hpp"

using namespace trellis;

namespace {

/// Log of the density at each point by the k nearest of the samples, by FNN's distances, averaged into figures.
const char* const program = R"R(
arguments <- commandArgs(trailingOnly = TRUE)
suppressPackageStartupMessages(library(FNN))
samples <- as.matrix(read.csv(arguments[1], header = FALSE))
points <- as.matrix(read.csv(arguments[2], header = FALSE))
log_t <- as.numeric(arguments[3])
log_u <- as.numeric(arguments[4])
n <- nrow(samples)
d <- ncol(samples)
for (k in as.integer(arguments[-(1:4)])) {
  r <- knnx.dist(samples, points, k = k)[, k]
  log_q <- digamma(k) - digamma(n + 1) - (d / 2 * log(pi) - lgamma(d / 2 + 1)) - d * log(r)
  mixed <- log(0.95 * exp(log_q) + 0.05 * exp(log_u))
  cat(sprintf("%.17g", log_t - c(mean(log_q), mean(mixed))), "\n")
}
)R";

bool succeeds(const std::string& command) {
  return std::system(command.c_str()) == 0;  // NOLINT(cert-env33-c,concurrency-mt-unsafe): one thread, a fixed command
}

bool has_fnn() {
  return succeeds("command -v Rscript >/dev/null 2>&1") &&
         succeeds(R"(Rscript -e 'quit(status = !requireNamespace("FNN", quietly = TRUE))' >/dev/null 2>&1)");
}

void write(const std::string& file, const Configurations& rows, std::size_t count) {
  std::ofstream out(file);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < rows.dimension(); ++j) out << fmt::format("{}{:.17g}", j == 0 ? "" : ",", rows[i][j]);
    out << '\n';
  }
}

}  // namespace

TEST_CASE("Plain nearest neighbours agree with R's FNN") {
  if (!has_fnn()) {
    WARN("not compared with FNN: R or its package FNN (r-cran-fnn) is not installed");
    return;
  }
  const std::vector<std::int64_t> ks = {1, 3, 8, 12};
  const test::Folder folder;
  std::ofstream(folder.file("fnn.R")) << program;
  for (const std::size_t d : {2U, 3U, 5U}) {
    const Space space = Space::euclidean(std::vector<std::pair<double, double>>(d, {0.0, 10.0}));
    Configurations path(d);
    path.push(Configuration(d, 3.0));
    path.push(Configuration(d, 6.0));
    TubeSettings settings;
    settings.distance = TubeSettings::Distance::full;
    settings.delta = 1.0;
    settings.points = 500;
    settings.pool = 1024;
    const Target target(
        space, path, {}, settings, [](View) { return true; }, 1);
    Stream stream(d, "", "fnn");
    Configurations samples(d);
    Configuration x(d);
    for (int i = 0; i < 2000; ++i) {
      for (double& c : x) c = i % 2 == 0 ? stream.uniform(0, 10) : stream.uniform(2, 7);
      samples.push(x);
    }
    write(folder.file("samples.csv"), samples, samples.size());
    write(folder.file("points.csv"), target.pool(), target.evaluation_points());
    std::string command =
        fmt::format("Rscript --vanilla '{}' '{}' '{}' {:.17g} {:.17g}", folder.file("fnn.R"),
                    folder.file("samples.csv"), folder.file("points.csv"), -target.log_volume(), -space.log_volume());
    for (const auto k : ks) command += fmt::format(" {}", k);
    REQUIRE(succeeds(command + " > '" + folder.file("out") + "'"));
    std::ifstream out(folder.file("out"));
    for (const auto k : ks) {
      std::array<double, 2> theirs{};
      for (double& figure : theirs) REQUIRE(out >> figure);
      const auto plain = EstimatorSpec::make("knn", {{"k", k}, {"k_all", k}, {"blend", false}, {"boundary", false}});
      const Efficiency ours = efficiency(target, samples, {.estimators = {plain}});
      INFO("d = " << d << ", k = " << k);
      CHECK(ours.unregularised == Approx(theirs[0]).epsilon(0).margin(1e-9));
      CHECK(ours.value == Approx(theirs[1]).epsilon(0).margin(1e-9));
    }
  }
}
