// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/planar/kernel.hpp>

#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <string>
#include <string_view>

#include <trellis/base/error.hpp>

namespace trellis::kernel {

namespace {

struct Available {
  std::array<const Table*, 3> tables{};
  unsigned count = 0;

  Available() {
    tables[count++] = &baseline;
#if defined(__x86_64__)
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx2")) tables[count++] = &avx2;
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) {
      tables[count++] = &avx512;
    }
#endif
  }
};

const Available& found() {
  static const Available instance;
  return instance;
}

}  // namespace

const Table* const* available(unsigned& count) {
  count = found().count;
  return found().tables.data();
}

const Table& best() {
  const Available& all = found();
  const char* wanted = std::getenv("TRELLIS_KERNEL");  // NOLINT(concurrency-mt-unsafe): nothing here sets it
  if (wanted == nullptr || *wanted == '\0') return *all.tables[all.count - 1];
  std::string names;
  for (unsigned i = 0; i < all.count; ++i) {
    if (std::string_view(all.tables[i]->name) == wanted) return *all.tables[i];
    names += fmt::format("{}{}", i > 0 ? ", " : "", all.tables[i]->name);
  }
  throw Error(fmt::format("TRELLIS_KERNEL: this processor has the instruction sets {}, got '{}'", names, wanted));
}

}  // namespace trellis::kernel
