// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/kernel.hpp>

#include <array>

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

const Table& best() { return *found().tables[found().count - 1]; }

}  // namespace trellis::kernel
