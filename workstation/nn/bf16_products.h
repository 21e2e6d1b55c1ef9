// Matrix products of factors rounded to bf16, 8 significant bits, with sums in fp32, by
// the processor's own instructions: AMX tiles (amx_bf16), or dot products of vector lanes
// (avx512_bf16). Behind plain pointers: the .cpp is compiled for these instructions whatever the
// build is compiled for, and must share no inline code with it.
//
// |error| of a sum of products <= (2^-7 + n 2^-23) sum |a b|: each factor is off by 2^-8 of itself,
// the sum of n terms is rounded n times; subnormal numbers count as zero.
#pragma once

#include <cstddef>

namespace bess::bf16 {

/// Element (row, column) at data[row + column * stride], like Eigen's.
template <typename Scalar>
struct View {
  Scalar* data;
  std::ptrdiff_t rows, columns, stride;
};
using Input = View<const float>;
using Output = View<float>;

/// Weights [lanes x depth] as Panels lays them: [panel][depth][panel_lanes].
struct Weights {
  const float* data;
  std::ptrdiff_t lanes, depth, panel_lanes;
};

enum class Unit { kNone, kDotProducts, kTiles };
/// The best that processor and system let this process use.
Unit best_unit();

/// What TileKernels says of the functions of the same names; `unit` must not be kNone.
void affine(Unit unit, const Input& x, const Weights& w, const float* bias, bool relu,
            const Output& y);
void backward(Unit unit, const Input& dy, const Weights& w, const Input& h, const Output& dh,
              float* db);
void backward_to_inputs(Unit unit, const Input& dy, const Weights& w, const Input& h,
                        const Input& x, const Output& dw, float* db);
void add_outer_products(Unit unit, const Input& lanes, const Input& rows, const Output& dw);

}  // namespace bess::bf16
