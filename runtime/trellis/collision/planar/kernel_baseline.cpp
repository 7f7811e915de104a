// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/planar/kernel.hpp>

// Two doubles at a time, with the compiler's vector types: every 64-bit processor supports this.

namespace trellis::kernel {

namespace {

using Pair = double __attribute__((vector_size(16)));
using PairMask = long long __attribute__((vector_size(16)));

constexpr long pairs = 4;

struct V {
  Pair p[pairs];  // NOLINT(modernize-avoid-c-arrays)
};
struct M {
  PairMask p[pairs];  // NOLINT(modernize-avoid-c-arrays)
};

#define TRELLIS_EACH_PAIR(Result, expression)             \
  Result r;                                               \
  for (long i = 0; i < pairs; ++i) r.p[i] = (expression); \
  return r

inline V spread(double x) { TRELLIS_EACH_PAIR(V, (Pair{x, x})); }
inline V load(const double* from) { TRELLIS_EACH_PAIR(V, (Pair{from[2 * i], from[2 * i + 1]})); }
inline void store(double* to, const V& a) {
  for (long i = 0; i < pairs; ++i) {
    to[2 * i] = a.p[i][0];
    to[2 * i + 1] = a.p[i][1];
  }
}
inline V operator+(const V& a, const V& b) { TRELLIS_EACH_PAIR(V, a.p[i] + b.p[i]); }
inline V operator-(const V& a, const V& b) { TRELLIS_EACH_PAIR(V, a.p[i] - b.p[i]); }
inline V operator*(const V& a, const V& b) { TRELLIS_EACH_PAIR(V, a.p[i] * b.p[i]); }
inline V operator/(const V& a, const V& b) { TRELLIS_EACH_PAIR(V, a.p[i] / b.p[i]); }
inline M operator<(const V& a, const V& b) { TRELLIS_EACH_PAIR(M, a.p[i] < b.p[i]); }
inline M operator<=(const V& a, const V& b) { TRELLIS_EACH_PAIR(M, a.p[i] <= b.p[i]); }
inline M equal(const V& a, const V& b) { TRELLIS_EACH_PAIR(M, a.p[i] == b.p[i]); }
inline M operator|(const M& a, const M& b) { TRELLIS_EACH_PAIR(M, a.p[i] | b.p[i]); }
inline M operator&(const M& a, const M& b) { TRELLIS_EACH_PAIR(M, a.p[i] & b.p[i]); }
inline M nowhere() { TRELLIS_EACH_PAIR(M, (PairMask{0, 0})); }
inline V select(const M& m, const V& a, const V& b) {
  TRELLIS_EACH_PAIR(V, reinterpret_cast<Pair>((m.p[i] & reinterpret_cast<PairMask>(a.p[i])) |
                                              (~m.p[i] & reinterpret_cast<PairMask>(b.p[i]))));
}
inline V min(const V& a, const V& b) { return select(a < b, a, b); }
inline V max(const V& a, const V& b) { return select(b < a, a, b); }
inline V abs(const V& a) {
  const PairMask all_but_sign = {0x7fffffffffffffffLL, 0x7fffffffffffffffLL};
  TRELLIS_EACH_PAIR(V, reinterpret_cast<Pair>(reinterpret_cast<PairMask>(a.p[i]) & all_but_sign));
}
inline V root(const V& a) { TRELLIS_EACH_PAIR(V, (Pair{__builtin_sqrt(a.p[i][0]), __builtin_sqrt(a.p[i][1])})); }
inline V negative_where(const M& m, const V& a) {
  const PairMask sign = {static_cast<long long>(0x8000000000000000ULL), static_cast<long long>(0x8000000000000000ULL)};
  TRELLIS_EACH_PAIR(V, reinterpret_cast<Pair>(reinterpret_cast<PairMask>(a.p[i]) ^ (m.p[i] & sign)));
}
inline unsigned bits(const M& m) {
  unsigned r = 0;
  for (long i = 0; i < pairs; ++i) {
    r |= (static_cast<unsigned>(m.p[i][0]) & 1U) << static_cast<unsigned>(2 * i);
    r |= (static_cast<unsigned>(m.p[i][1]) & 1U) << static_cast<unsigned>(2 * i + 1);
  }
  return r;
}

#undef TRELLIS_EACH_PAIR

#include <trellis/collision/planar/kernel_impl.inl>
#include <trellis/collision/spatial/sphere_kernel.inl>

}  // namespace

const Table baseline = {"baseline",  &poses_of, &place,      &outside,        &collide,      &move_chain,
                        &meet_chain, &touches,  &rate_chain, &approach_chain, &measure_chain};

}  // namespace trellis::kernel
