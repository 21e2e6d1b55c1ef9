#include "workstation/nn/bf16_products.h"

#ifdef __AVX512BF16__

#include <immintrin.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

namespace bess::bf16 {
namespace {

using Index = std::ptrdiff_t;

/// A product is made of blocks of kRows x kLanes sums. Rows are samples (weight rows in
/// add_outer_products), lanes lie side by side in memory.
constexpr Index kRows = 32;
constexpr Index kLanes = 32;
constexpr Index kVector = 16;  ///< fp32 in a register, pairs of bf16 in a Line
constexpr Index kDepth = 32;   ///< bf16 of a row in a Line

/// One register: of a row 32 values along the depth, or of 16 lanes a pair of such values each.
struct alignas(64) Line {
  std::uint32_t pair[kVector];
};
struct alignas(64) Block {
  float at[kRows][kLanes];
};
/// [row][line of the depth], rows padded to whole blocks, what is padded is zero.
using RowFactors = std::vector<Line>;
/// [vector of lanes][pair of the depth], padded alike.
using LaneFactors = std::vector<Line>;

/// Kept from call to call: a team's threads each have their own.
struct Factors {
  RowFactors rows;
  LaneFactors lanes;
};
Factors& factors() {
  thread_local Factors kept;
  return kept;
}

constexpr Index in_whole(Index count, Index unit) { return (count + unit - 1) / unit; }

__mmask16 first_lanes(Index count) {
  return static_cast<__mmask16>((1U << std::clamp<Index>(count, 0, kVector)) - 1);
}

void keep(__m512bh values, Line& line) { std::memcpy(&line, &values, sizeof line); }

/// 16 lanes of an even depth and the odd one above, side by side.
__m512i pairs_of(__m512 even, __m512 odd) {
  alignas(64) static constexpr std::uint16_t kInterleaved[32] = {
      0, 16, 1, 17, 2,  18, 3,  19, 4,  20, 5,  21, 6,  22, 7,  23,
      8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31};
  const __m512bh both = _mm512_cvtne2ps_pbh(odd, even);
  __m512i bits;
  std::memcpy(&bits, &both, sizeof bits);
  return _mm512_permutexvar_epi16(_mm512_load_si512(kInterleaved), bits);
}

/// Each column is a row of the product: its values lie along the depth already.
void pack_columns(const Input& x, RowFactors& to) {
  const Index lines = in_whole(x.rows, kDepth);
  to.resize(static_cast<std::size_t>(in_whole(x.columns, kRows) * kRows * lines));
  Line* line = to.data();
  for (Index n = 0; n < x.columns; ++n) {
    const float* from = x.data + n * x.stride;
    for (Index k = 0; k < x.rows; k += kDepth) {
      const __m512 low = _mm512_maskz_loadu_ps(first_lanes(x.rows - k), from + k);
      const __m512 high =
          _mm512_maskz_loadu_ps(first_lanes(x.rows - k - kVector), from + k + kVector);
      keep(_mm512_cvtne2ps_pbh(high, low), *line++);
    }
  }
  std::fill(line, to.data() + to.size(), Line{});
}

/// What a stage of transpose() takes from two registers: of two squares the low or the high row.
struct Selection {
  alignas(64) std::int32_t low[kVector], high[kVector];
};
constexpr Selection selection_at(Index distance) {
  Selection from{};
  for (Index i = 0; i < kVector; ++i) {
    const bool is_left = (i & distance) == 0;
    from.low[i] = static_cast<std::int32_t>(is_left ? i : kVector + i - distance);
    from.high[i] = static_cast<std::int32_t>(is_left ? i + distance : kVector + i);
  }
  return from;
}

template <Index distance>
void exchange(__m512i (&lines)[kVector]) {
  static constexpr Selection kFrom = selection_at(distance);
  const __m512i low = _mm512_load_si512(kFrom.low);
  const __m512i high = _mm512_load_si512(kFrom.high);
  for (Index i = 0; i < kVector; ++i) {
    if ((i & distance) != 0) continue;
    const __m512i a = lines[i];
    const __m512i b = lines[i + distance];
    lines[i] = _mm512_permutex2var_epi32(a, low, b);
    lines[i + distance] = _mm512_permutex2var_epi32(a, high, b);
  }
}

/// 16 x 16 pairs: line i becomes what stood at place i of each.
void transpose(__m512i (&lines)[kVector]) {
  exchange<1>(lines);
  exchange<2>(lines);
  exchange<4>(lines);
  exchange<8>(lines);
}

/// Each row is a row of the product and samples are its depth.
void pack_rows(const Input& x, RowFactors& to) {
  const Index lines = in_whole(x.columns, kDepth);
  const Index rows = in_whole(x.rows, kRows) * kRows;
  to.resize(static_cast<std::size_t>(rows * lines));
  for (Index r = 0; r < rows; r += kVector) {
    const __mmask16 there = first_lanes(x.rows - r);
    for (Index line = 0; line < lines; ++line) {
      const auto values = [&](Index n) {
        return n < x.columns ? _mm512_maskz_loadu_ps(there, x.data + r + n * x.stride)
                             : _mm512_setzero_ps();
      };
      __m512i at[kVector];
      for (Index pair = 0; pair < kVector; ++pair) {
        const Index n = line * kDepth + 2 * pair;
        at[pair] = pairs_of(values(n), values(n + 1));
      }
      transpose(at);
      for (Index i = 0; i < kVector; ++i) {
        _mm512_store_si512(&to[static_cast<std::size_t>((r + i) * lines + line)], at[i]);
      }
    }
  }
}

/// `start(lane)`: where eight lanes from `lane` on stand at depth 0; the next is `stride` further.
template <typename Start>
void pack_lanes(Index lanes, Index depth, const Start& start, Index stride, LaneFactors& to) {
  constexpr Index kEight = 8;
  const Index pairs = in_whole(depth, kDepth) * kVector;
  const Index vectors = in_whole(lanes, kLanes) * (kLanes / kVector);
  to.resize(static_cast<std::size_t>(vectors * pairs));
  Line* line = to.data();
  for (Index v = 0; v < vectors; ++v) {
    const Index lane = v * kVector;
    const float* const low = lane < lanes ? start(lane) : nullptr;
    const float* const high = lane + kEight < lanes ? start(lane + kEight) : nullptr;
    const auto eight = [&](const float* from, Index k) {
      return from != nullptr && k < depth ? _mm256_loadu_ps(from + k * stride)
                                          : _mm256_setzero_ps();
    };
    const auto sixteen = [&](Index k) {
      return _mm512_insertf32x8(_mm512_castps256_ps512(eight(low, k)), eight(high, k), 1);
    };
    for (Index p = 0; p < pairs; ++p) {
      _mm512_store_si512(line++, pairs_of(sixteen(2 * p), sixteen(2 * p + 1)));
    }
  }
}

void pack_weights(const Weights& w, LaneFactors& to) {
  pack_lanes(
      w.lanes, w.depth,
      [&](Index lane) {
        return w.data + lane / w.panel_lanes * w.panel_lanes * w.depth + lane % w.panel_lanes;
      },
      w.panel_lanes, to);
}

/// Eight rows at a time: 16 sums hide the latency of the unit.
void multiply_by_dot_products(const Line* rows, const Line* lanes, Index lines, Block& block) {
  constexpr Index kTogether = 8;
  const Line* const right = lanes + lines * kVector;
  for (Index first = 0; first < kRows; first += kTogether) {
    __m512 sum[kTogether][2];
    for (auto& row : sum) row[0] = row[1] = _mm512_setzero_ps();
    const std::uint32_t* row_pairs = rows[first * lines].pair;
    for (Index p = 0; p < lines * kVector; ++p) {
      const auto left_pairs = (__m512bh)_mm512_load_si512(lanes + p);
      const auto right_pairs = (__m512bh)_mm512_load_si512(right + p);
      for (Index r = 0; r < kTogether; ++r) {
        const auto pair = static_cast<int>(row_pairs[r * lines * kVector + p]);
        const auto row = (__m512bh)_mm512_set1_epi32(pair);
        sum[r][0] = _mm512_dpbf16_ps(sum[r][0], row, left_pairs);
        sum[r][1] = _mm512_dpbf16_ps(sum[r][1], row, right_pairs);
      }
    }
    for (Index r = 0; r < kTogether; ++r) {
      _mm512_store_ps(block.at[first + r], sum[r][0]);
      _mm512_store_ps(block.at[first + r] + kVector, sum[r][1]);
    }
  }
}

/// Four tiles of 16 x 16 sums, two of rows and two of lanes.
void multiply_by_tiles(const Line* rows, const Line* lanes, Index lines, Block& block) {
  const Index row_bytes = lines * static_cast<Index>(sizeof(Line));
  constexpr Index kLineBytes = sizeof(Line);
  constexpr Index kBlockBytes = kLanes * sizeof(float);
  const Line* const lower_rows = rows + kVector * lines;
  const Line* const right = lanes + lines * kVector;
  _tile_zero(0);
  _tile_zero(1);
  _tile_zero(2);
  _tile_zero(3);
  for (Index line = 0; line < lines; ++line) {
    _tile_loadd(4, rows + line, row_bytes);
    _tile_loadd(5, lower_rows + line, row_bytes);
    _tile_loadd(6, lanes + line * kVector, kLineBytes);
    _tile_loadd(7, right + line * kVector, kLineBytes);
    _tile_dpbf16ps(0, 4, 6);
    _tile_dpbf16ps(1, 4, 7);
    _tile_dpbf16ps(2, 5, 6);
    _tile_dpbf16ps(3, 5, 7);
  }
  _tile_stored(0, block.at[0], kBlockBytes);
  _tile_stored(1, block.at[0] + kVector, kBlockBytes);
  _tile_stored(2, block.at[kVector], kBlockBytes);
  _tile_stored(3, block.at[kVector] + kVector, kBlockBytes);
}

/// The eight tiles of a thread, 16 rows of 64 bytes each, for as long as this lives.
class Tiles {
 public:
  explicit Tiles(Unit unit) : used_(unit == Unit::kTiles) {
    if (!used_) return;
    struct alignas(64) {
      std::uint8_t palette = 1, start_row = 0, reserved[14] = {};
      std::uint16_t row_bytes[16] = {64, 64, 64, 64, 64, 64, 64, 64};
      std::uint8_t rows[16] = {16, 16, 16, 16, 16, 16, 16, 16};
    } config;
    _tile_loadconfig(&config);
  }
  Tiles(const Tiles&) = delete;
  Tiles& operator=(const Tiles&) = delete;
  ~Tiles() {
    if (used_) _tile_release();
  }

 private:
  bool used_;
};

/// Calls use(first row, first lane, block) for every block of the product of the packed factors.
template <typename Use>
void for_blocks(Unit unit, const Factors& of, Index rows, Index lanes, Index depth,
                const Use& use) {
  const Tiles tiles(unit);
  const Index lines = in_whole(depth, kDepth);
  Block block;
  for (Index lane = 0; lane < lanes; lane += kLanes) {
    const Line* const lane_factors = of.lanes.data() + lane / kVector * lines * kVector;
    for (Index row = 0; row < rows; row += kRows) {
      const Line* const row_factors = of.rows.data() + row * lines;
      if (unit == Unit::kTiles) {
        multiply_by_tiles(row_factors, lane_factors, lines, block);
      } else {
        multiply_by_dot_products(row_factors, lane_factors, lines, block);
      }
      use(row, lane, block);
    }
  }
}

/// Calls body(lane within the block, mask) for the block's vectors that hold lanes.
template <typename Body>
void for_vectors(Index lane, Index lanes, const Body& body) {
  for (Index v = 0; v < kLanes && lane + v < lanes; v += kVector) {
    body(v, first_lanes(lanes - lane - v));
  }
}

/// dh = sums where h > 0, else 0, left in the block; db += dh.
void mask_and_sum(const Input& h, Index row, Index lane, Block& block, float* db) {
  const Index samples = std::min(kRows, h.columns - row);
  for_vectors(lane, h.rows, [&](Index v, __mmask16 there) {
    __m512 sum = _mm512_maskz_loadu_ps(there, db + lane + v);
    for (Index r = 0; r < samples; ++r) {
      const __m512 gate = _mm512_maskz_loadu_ps(there, h.data + lane + v + (row + r) * h.stride);
      const __mmask16 open = _mm512_cmp_ps_mask(gate, _mm512_setzero_ps(), _CMP_GT_OQ);
      const __m512 dh = _mm512_maskz_load_ps(open, block.at[r] + v);
      _mm512_store_ps(block.at[r] + v, dh);
      sum = _mm512_add_ps(sum, dh);
    }
    _mm512_mask_storeu_ps(db + lane + v, there, sum);
  });
}

/// From Linux 5.16 on a process asks before it may use the tiles, for all of its threads.
bool tiles_are_allowed() {
  constexpr long kRequestPermission = 0x1023;  // ARCH_REQ_XCOMP_PERM
  constexpr long kTileData = 18;               // XFEATURE_XTILEDATA
  return syscall(SYS_arch_prctl, kRequestPermission, kTileData) == 0;
}

}  // namespace

Unit best_unit() {
  __builtin_cpu_init();
  const bool has_vectors = __builtin_cpu_supports("avx512bf16") != 0 &&
                           __builtin_cpu_supports("avx512bw") != 0 &&
                           __builtin_cpu_supports("avx512dq") != 0;
  if (!has_vectors) return Unit::kNone;
  std::uint32_t a = 7, b = 0, c = 0, d = 0;
  asm("cpuid" : "+a"(a), "=b"(b), "+c"(c), "=d"(d));
  constexpr std::uint32_t kAmxBf16 = 1U << 22, kAmxTile = 1U << 24;
  const bool has_tiles = (d & kAmxBf16) != 0 && (d & kAmxTile) != 0;
  return has_tiles && tiles_are_allowed() ? Unit::kTiles : Unit::kDotProducts;
}

void affine(Unit unit, const Input& x, const Weights& w, const float* bias, bool relu,
            const Output& y) {
  Factors& of = factors();
  pack_columns(x, of.rows);
  pack_weights(w, of.lanes);
  const __m512 floor = _mm512_set1_ps(relu ? 0.0F : -__builtin_inff());
  for_blocks(unit, of, x.columns, w.lanes, w.depth, [&](Index row, Index lane, Block& block) {
    const Index samples = std::min(kRows, x.columns - row);
    for_vectors(lane, w.lanes, [&](Index v, __mmask16 there) {
      const __m512 offset = _mm512_maskz_loadu_ps(there, bias + lane + v);
      for (Index r = 0; r < samples; ++r) {
        const __m512 sum = _mm512_add_ps(_mm512_load_ps(block.at[r] + v), offset);
        _mm512_mask_storeu_ps(y.data + lane + v + (row + r) * y.stride, there,
                              _mm512_max_ps(sum, floor));
      }
    });
  });
}

void backward(Unit unit, const Input& dy, const Weights& w, const Input& h, const Output& dh,
              float* db) {
  Factors& of = factors();
  pack_columns(dy, of.rows);
  pack_weights(w, of.lanes);
  for_blocks(unit, of, dy.columns, w.lanes, w.depth, [&](Index row, Index lane, Block& block) {
    mask_and_sum(h, row, lane, block, db);
    const Index samples = std::min(kRows, dy.columns - row);
    for_vectors(lane, w.lanes, [&](Index v, __mmask16 there) {
      for (Index r = 0; r < samples; ++r) {
        _mm512_mask_storeu_ps(dh.data + lane + v + (row + r) * dh.stride, there,
                              _mm512_load_ps(block.at[r] + v));
      }
    });
  });
}

/// The last product, with the inputs, is left in fp32: it is small, its factors are not rounded.
void backward_to_inputs(Unit unit, const Input& dy, const Weights& w, const Input& h,
                        const Input& x, const Output& dw, float* db) {
  Factors& of = factors();
  pack_columns(dy, of.rows);
  pack_weights(w, of.lanes);
  for_blocks(unit, of, dy.columns, w.lanes, w.depth, [&](Index row, Index lane, Block& block) {
    mask_and_sum(h, row, lane, block, db);
    const Index samples = std::min(kRows, dy.columns - row);
    for_vectors(lane, w.lanes, [&](Index v, __mmask16 there) {
      for (Index input = 0; input < x.rows; ++input) {
        float* const to = dw.data + lane + v + input * dw.stride;
        __m512 sum = _mm512_maskz_loadu_ps(there, to);
        for (Index r = 0; r < samples; ++r) {
          const __m512 factor = _mm512_set1_ps(x.data[input + (row + r) * x.stride]);
          sum = _mm512_fmadd_ps(factor, _mm512_load_ps(block.at[r] + v), sum);
        }
        _mm512_mask_storeu_ps(to, there, sum);
      }
    });
  });
}

void add_outer_products(Unit unit, const Input& lanes, const Input& rows, const Output& dw) {
  Factors& of = factors();
  pack_rows(rows, of.rows);
  pack_lanes(
      lanes.rows, lanes.columns, [&](Index lane) { return lanes.data + lane; }, lanes.stride,
      of.lanes);
  for_blocks(
      unit, of, rows.rows, lanes.rows, lanes.columns, [&](Index row, Index lane, Block& block) {
        for_vectors(lane, lanes.rows, [&](Index v, __mmask16 there) {
          for (Index r = 0; r < std::min(kRows, rows.rows - row); ++r) {
            float* const to = dw.data + lane + v + (row + r) * dw.stride;
            const __m512 sum =
                _mm512_add_ps(_mm512_maskz_loadu_ps(there, to), _mm512_load_ps(block.at[r] + v));
            _mm512_mask_storeu_ps(to, there, sum);
          }
        });
      });
}

}  // namespace bess::bf16

#else  // no such processor: the table of kernels is never handed out

namespace bess::bf16 {

Unit best_unit() { return Unit::kNone; }
void affine(Unit, const Input&, const Weights&, const float*, bool, const Output&) {}
void backward(Unit, const Input&, const Weights&, const Input&, const Output&, float*) {}
void backward_to_inputs(Unit, const Input&, const Weights&, const Input&, const Input&,
                        const Output&, float*) {}
void add_outer_products(Unit, const Input&, const Input&, const Output&) {}

}  // namespace bess::bf16

#endif
