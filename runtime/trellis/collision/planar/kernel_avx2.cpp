// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/planar/kernel.hpp>

#if defined(__AVX2__)

#include <immintrin.h>

namespace trellis::kernel {

namespace {

struct V {
  __m256d a, b;
};
struct M {
  __m256d a, b;
};

inline V spread(double x) { return {_mm256_set1_pd(x), _mm256_set1_pd(x)}; }
inline V load(const double* from) { return {_mm256_load_pd(from), _mm256_load_pd(from + 4)}; }
inline void store(double* to, V v) {
  _mm256_store_pd(to, v.a);
  _mm256_store_pd(to + 4, v.b);
}
inline V operator+(V p, V q) { return {_mm256_add_pd(p.a, q.a), _mm256_add_pd(p.b, q.b)}; }
inline V operator-(V p, V q) { return {_mm256_sub_pd(p.a, q.a), _mm256_sub_pd(p.b, q.b)}; }
inline V operator*(V p, V q) { return {_mm256_mul_pd(p.a, q.a), _mm256_mul_pd(p.b, q.b)}; }
inline V operator/(V p, V q) { return {_mm256_div_pd(p.a, q.a), _mm256_div_pd(p.b, q.b)}; }
inline M operator<(V p, V q) { return {_mm256_cmp_pd(p.a, q.a, _CMP_LT_OQ), _mm256_cmp_pd(p.b, q.b, _CMP_LT_OQ)}; }
inline M operator<=(V p, V q) { return {_mm256_cmp_pd(p.a, q.a, _CMP_LE_OQ), _mm256_cmp_pd(p.b, q.b, _CMP_LE_OQ)}; }
inline M equal(V p, V q) { return {_mm256_cmp_pd(p.a, q.a, _CMP_EQ_OQ), _mm256_cmp_pd(p.b, q.b, _CMP_EQ_OQ)}; }
inline M operator|(M p, M q) { return {_mm256_or_pd(p.a, q.a), _mm256_or_pd(p.b, q.b)}; }
inline M operator&(M p, M q) { return {_mm256_and_pd(p.a, q.a), _mm256_and_pd(p.b, q.b)}; }
inline M nowhere() { return {_mm256_setzero_pd(), _mm256_setzero_pd()}; }
inline V select(M m, V p, V q) { return {_mm256_blendv_pd(q.a, p.a, m.a), _mm256_blendv_pd(q.b, p.b, m.b)}; }
inline V min(V p, V q) { return {_mm256_min_pd(p.a, q.a), _mm256_min_pd(p.b, q.b)}; }
inline V max(V p, V q) { return {_mm256_max_pd(p.a, q.a), _mm256_max_pd(p.b, q.b)}; }
inline V abs(V p) {
  const __m256d sign = _mm256_set1_pd(-0.0);
  return {_mm256_andnot_pd(sign, p.a), _mm256_andnot_pd(sign, p.b)};
}
inline V root(V p) { return {_mm256_sqrt_pd(p.a), _mm256_sqrt_pd(p.b)}; }
inline V negative_where(M m, V p) {
  const __m256d sign = _mm256_set1_pd(-0.0);
  return {_mm256_xor_pd(p.a, _mm256_and_pd(m.a, sign)), _mm256_xor_pd(p.b, _mm256_and_pd(m.b, sign))};
}
inline unsigned bits(M m) {
  return static_cast<unsigned>(_mm256_movemask_pd(m.a)) | (static_cast<unsigned>(_mm256_movemask_pd(m.b)) << 4U);
}

#include <trellis/collision/planar/kernel_impl.inl>
#include <trellis/collision/spatial/sphere_kernel.inl>

}  // namespace

const Table avx2 = {"avx2",      &poses_of, &place,      &outside,        &collide,      &move_chain,
                    &meet_chain, &touches,  &rate_chain, &approach_chain, &measure_chain};

}  // namespace trellis::kernel

#endif
