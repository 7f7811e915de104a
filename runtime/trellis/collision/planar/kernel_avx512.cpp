// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/planar/kernel.hpp>

#if defined(__AVX512F__) && defined(__AVX512DQ__)

// g++ 12 warns about its own _mm512_undefined_pd, which the intrinsics below pass for lanes outside the mask.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"
#endif

#include <immintrin.h>

namespace trellis::kernel {

namespace {

struct V {
  __m512d a;
};
struct M {
  __mmask8 a;
};

inline V spread(double x) { return {_mm512_set1_pd(x)}; }
inline V load(const double* from) { return {_mm512_load_pd(from)}; }
inline void store(double* to, V v) { _mm512_store_pd(to, v.a); }
inline V operator+(V p, V q) { return {_mm512_add_pd(p.a, q.a)}; }
inline V operator-(V p, V q) { return {_mm512_sub_pd(p.a, q.a)}; }
inline V operator*(V p, V q) { return {_mm512_mul_pd(p.a, q.a)}; }
inline V operator/(V p, V q) { return {_mm512_div_pd(p.a, q.a)}; }
inline M operator<(V p, V q) { return {_mm512_cmp_pd_mask(p.a, q.a, _CMP_LT_OQ)}; }
inline M operator<=(V p, V q) { return {_mm512_cmp_pd_mask(p.a, q.a, _CMP_LE_OQ)}; }
inline M equal(V p, V q) { return {_mm512_cmp_pd_mask(p.a, q.a, _CMP_EQ_OQ)}; }
inline M operator|(M p, M q) { return {static_cast<__mmask8>(p.a | q.a)}; }
inline M operator&(M p, M q) { return {static_cast<__mmask8>(p.a & q.a)}; }
inline M nowhere() { return {0}; }
inline V select(M m, V p, V q) { return {_mm512_mask_blend_pd(m.a, q.a, p.a)}; }
inline V min(V p, V q) { return {_mm512_min_pd(p.a, q.a)}; }
inline V max(V p, V q) { return {_mm512_max_pd(p.a, q.a)}; }
inline V abs(V p) { return {_mm512_andnot_pd(_mm512_set1_pd(-0.0), p.a)}; }
inline V root(V p) { return {_mm512_sqrt_pd(p.a)}; }
inline V negative_where(M m, V p) { return {_mm512_mask_xor_pd(p.a, m.a, p.a, _mm512_set1_pd(-0.0))}; }
inline unsigned bits(M m) { return m.a; }

#include <trellis/collision/planar/kernel_impl.inl>
#include <trellis/collision/spatial/sphere_kernel.inl>

}  // namespace

const Table avx512 = {"avx512",    &poses_of, &place,      &outside,        &collide,      &move_chain,
                      &meet_chain, &touches,  &rate_chain, &approach_chain, &measure_chain};

}  // namespace trellis::kernel

#endif
