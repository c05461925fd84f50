#include "solve/single_precision.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <type_traits>

namespace amontons {

namespace {

/// Read access to pattern and numbers of a sequential AIJ matrix for the life of the scope.
class RowReader {
 public:
  explicit RowReader(Mat matrix) : matrix_(matrix) {
    PetscBool done = PETSC_FALSE;
    AMT_PETSC(MatGetRowIJ(matrix_, 0, PETSC_FALSE, PETSC_FALSE, &size, &start, &column, &done));
    AMT_PETSC(MatSeqAIJGetArrayRead(matrix_, &number));
  }
  ~RowReader() {
    PetscBool done = PETSC_FALSE;
    MatSeqAIJRestoreArrayRead(matrix_, &number);
    MatRestoreRowIJ(matrix_, 0, PETSC_FALSE, PETSC_FALSE, &size, &start, &column, &done);
  }
  RowReader(const RowReader&) = delete;
  RowReader& operator=(const RowReader&) = delete;

  PetscInt size = 0;
  const PetscInt* start = nullptr;
  const PetscInt* column = nullptr;
  const PetscScalar* number = nullptr;

 private:
  Mat matrix_;
};

/// Block columns of a block row, ascending: those in which any of its rows has an entry.
void gather_columns(const RowReader& rows, PetscInt first, int block, std::vector<std::int32_t>& found) {
  found.clear();
  for (PetscInt j = rows.start[first]; j < rows.start[first + block]; ++j)
    found.push_back(static_cast<std::int32_t>(rows.column[j] / block));
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
}

/// The power of two next to the largest number: what numbers are measured in, so that units do not matter. Tangents of
/// one pattern have numbers of one size.
double unit_of(Mat matrix) {
  const RowReader rows(matrix);
  double largest = 0.0;
  for (PetscInt j = 0; j < rows.start[rows.size]; ++j)
    largest = std::max(largest, std::abs(rows.number[j]));
  return largest > 0.0 && std::isfinite(largest) ? std::exp2(std::ceil(std::log2(largest))) : 1.0;
}

// Kernels are made for processors with AVX2, too, which widen four numbers at once; without fused operations, so that
// sums are the same everywhere. Sanitizers start after the choice among clones is made.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)
#define AMT_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define AMT_WIDE
#endif
#define AMT_INLINE [[gnu::always_inline]] inline

constexpr std::size_t spare = 1; // numbers behind the last one that are read, and not looked at

/// Numbers that are kept side by side for the vector units: those of blocks of 3 with a fourth that nobody looks at.
template <int B>
inline constexpr int padded = B == 3 ? 4 : B;

/// `padded` numbers in double precision.
template <int B>
struct Lanes {
  using Wide = double __attribute__((vector_size(32)));
  using Narrow = float __attribute__((vector_size(16)));
  std::conditional_t<B == 3, Wide, std::array<double, B>> lane{};

  AMT_INLINE void add_product(const float* numbers, double factor) {
    if constexpr (B == 3) {
      Narrow narrow;
      std::memcpy(&narrow, numbers, sizeof(narrow));
      lane += __builtin_convertvector(narrow, Wide) * factor;
    } else {
      for (int c = 0; c < B; ++c)
        lane[c] += static_cast<double>(numbers[c]) * factor;
    }
  }
  AMT_INLINE void add_product(const float* numbers, const double* factors) {
    if constexpr (B == 3) {
      Narrow narrow;
      Wide wide;
      std::memcpy(&narrow, numbers, sizeof(narrow));
      std::memcpy(&wide, factors, sizeof(wide));
      lane += __builtin_convertvector(narrow, Wide) * wide;
    } else {
      for (int c = 0; c < B; ++c)
        lane[c] += static_cast<double>(numbers[c]) * factors[c];
    }
  }
  AMT_INLINE double sum() const {
    double whole = lane[0];
    for (int c = 1; c < B; ++c)
      whole += lane[c];
    return whole;
  }
  /// numbers -= these
  AMT_INLINE void take_off(double* numbers) const {
    if constexpr (B == 3) {
      Wide wide;
      std::memcpy(&wide, numbers, sizeof(wide));
      wide -= lane;
      std::memcpy(numbers, &wide, sizeof(wide));
    } else {
      for (int c = 0; c < B; ++c)
        numbers[c] -= lane[c];
    }
  }
};

/// y = A x or y += A x, blocks column by column. Columns have sums of their own: additions that wait for each other are
/// the slower part.
template <int B>
AMT_INLINE void product(const BlockRows& rows, const float* numbers, double unit, bool adds, const double* x,
                        double* y) {
  for (std::int32_t i = 0; i < rows.size(); ++i) {
    if (adds && rows.start[i] == rows.start[i + 1]) continue; // most rows have no columns of other ranks
    std::array<Lanes<B>, B> sum;
    for (std::int32_t e = rows.start[i]; e < rows.start[i + 1]; ++e) {
      const float* block = numbers + static_cast<std::size_t>(e) * B * B;
      const double* piece = x + static_cast<std::size_t>(rows.column[e]) * B;
      for (int c = 0; c < B; ++c)
        sum[c].add_product(block + c * B, piece[c]);
    }
    for (int r = 0; r < B; ++r) {
      double whole = sum[0].lane[r];
      for (int c = 1; c < B; ++c)
        whole += sum[c].lane[r];
      y[i * B + r] = (adds ? y[i * B + r] : 0.0) + unit * whole;
    }
  }
}

/// Factors as SinglePrecisionFactors keeps them.
struct Factors {
  const BlockRows& lower;
  const std::int32_t* source;
  const float* numbers;
  const float* inverse;
  double unit;
  double* work; // two vectors with `padded` numbers a block
};

template <int B>
AMT_INLINE void substitute(const Factors& factors, const double* b, double* x) {
  constexpr std::size_t P = padded<B>;
  const auto& lower = factors.lower;
  double* z = factors.work;                                                 // D⁻¹ y, where (I + L D⁻¹) y = b
  double* rest = factors.work + P * static_cast<std::size_t>(lower.size()); // y, and then y - Lᵀ x
  const auto solve_block = [&](std::int32_t i, double* to) {
    Lanes<B> solution;
    for (int c = 0; c < B; ++c) // symmetric: rows are columns
      solution.add_product(factors.inverse + static_cast<std::size_t>(i) * B * B + c * B, rest[i * P + c]);
    for (int r = 0; r < B; ++r)
      to[r] = solution.lane[r];
  };
  for (std::int32_t i = 0; i < lower.size(); ++i) {
    std::array<Lanes<B>, B> sum;
    for (std::int32_t e = lower.start[i]; e < lower.start[i + 1]; ++e)
      for (int r = 0; r < B; ++r)
        sum[r].add_product(factors.numbers + static_cast<std::size_t>(e) * B * B + r * B, z + lower.column[e] * P);
    for (int r = 0; r < B; ++r)
      rest[i * P + r] = b[factors.source[i] * B + r] - sum[r].sum();
    if constexpr (P > B) rest[i * P + B] = 0.0;
    solve_block(i, z + i * P);
  }
  // x = D⁻¹ (y - Lᵀ x). Row i of L is column i of its transpose: once its x is known, it is taken off the earlier rows.
  for (std::int32_t i = lower.size() - 1; i >= 0; --i) {
    std::array<double, B> own;
    solve_block(i, own.data());
    for (int r = 0; r < B; ++r)
      x[factors.source[i] * B + r] = own[r] / factors.unit;
    // Backwards all through, so that memory is fetched ahead.
    for (std::int32_t e = lower.start[i + 1] - 1; e >= lower.start[i]; --e) {
      Lanes<B> part;
      for (int r = 0; r < B; ++r)
        part.add_product(factors.numbers + static_cast<std::size_t>(e) * B * B + r * B, own[r]);
      part.take_off(rest + lower.column[e] * P);
    }
  }
}

/// Calls `work` with the block's size as a type: sums over blocks are unrolled for the sizes that there are.
template <class Work>
AMT_INLINE decltype(auto) with_block(int block, Work&& work) {
  switch (block) {
  case 2:
    return work(std::integral_constant<int, 2>{});
  case 3:
    return work(std::integral_constant<int, 3>{});
  case 6:
    return work(std::integral_constant<int, 6>{});
  default:
    return work(std::integral_constant<int, 1>{});
  }
}

AMT_WIDE void multiply_blocks(const BlockRows& rows, const float* numbers, double unit, bool adds, const double* x,
                              double* y) {
  with_block(
      rows.block, [&](auto size) __attribute__((always_inline)) { product<size()>(rows, numbers, unit, adds, x, y); });
}

AMT_WIDE void substitute_blocks(const Factors& factors, const double* b, double* x) {
  with_block(
      factors.lower.block, [&](auto size) __attribute__((always_inline)) { substitute<size()>(factors, b, x); });
}

/// Inverse of a symmetric positive definite matrix in place; false if it is not.
template <int B>
bool invert(std::array<double, B * B>& matrix) {
  std::array<double, B * B> root{}; // lower triangle of its Cholesky factor, then the inverse of that
  for (int i = 0; i < B; ++i)
    for (int j = 0; j <= i; ++j) {
      double sum = matrix[i * B + j];
      for (int k = 0; k < j; ++k)
        sum -= root[i * B + k] * root[j * B + k];
      if (i != j) {
        root[i * B + j] = sum / root[j * B + j];
      } else {
        constexpr double nothing_left = 1e-8; // of what there was: more than rounding of the numbers leaves
        if (!(sum > nothing_left * matrix[i * B + i])) return false;
        root[i * B + i] = std::sqrt(sum);
      }
    }
  for (int j = 0; j < B; ++j) {
    root[j * B + j] = 1.0 / root[j * B + j];
    for (int i = j + 1; i < B; ++i) {
      double sum = 0.0;
      for (int k = j; k < i; ++k)
        sum -= root[i * B + k] * root[k * B + j];
      root[i * B + j] = sum / root[i * B + i];
    }
  }
  for (int i = 0; i < B; ++i)
    for (int j = 0; j <= i; ++j) {
      double sum = 0.0;
      for (int k = i; k < B; ++k)
        sum += root[k * B + i] * root[k * B + j];
      matrix[i * B + j] = matrix[j * B + i] = sum;
    }
  return true;
}

/// The diagonal of an incomplete factorization, positive and larger by `shift`. Equations of nothing, as coarse levels
/// have them where all of a mode is prescribed, are given something: nothing acts on them.
void complete_pivot(double& pivot, double shift) {
  constexpr double nothing = 1e-14; // of the largest number
  pivot = std::abs(pivot) <= nothing ? 1.0 : std::abs(pivot) * (1.0 + shift);
}

/// New block row -> old one.
std::vector<std::int32_t> cuthill_mckee(const BlockRows& rows) {
  std::vector<PetscInt> start(rows.start.begin(), rows.start.end()), column(rows.column.begin(), rows.column.end());
  std::vector<PetscScalar> nothing(column.size());
  MatHandle graph;
  IsHandle order, same;
  AMT_PETSC(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, rows.size(), rows.size(), start.data(), column.data(),
                                      nothing.data(), graph.put()));
  AMT_PETSC(MatGetOrdering(graph, MATORDERINGRCM, order.put(), same.put()));
  const PetscInt* source = nullptr;
  AMT_PETSC(ISGetIndices(order, &source));
  std::vector<std::int32_t> found(source, source + rows.size());
  AMT_PETSC(ISRestoreIndices(order, &source));
  return found;
}

} // namespace

BlockRows block_rows(Mat matrix, int block) {
  // Numbers in blocks over numbers that there are, up to which blocks pay: a number alone has an index of its own.
  constexpr double most_filling = 1.5;
  const RowReader rows(matrix);
  const auto in_blocks_of = [&](int size) {
    BlockRows found{size, {0}, {}};
    std::vector<std::int32_t> columns;
    for (PetscInt first = 0; first < rows.size; first += size) {
      gather_columns(rows, first, size, columns);
      found.column.insert(found.column.end(), columns.begin(), columns.end());
      found.start.push_back(static_cast<std::int32_t>(found.column.size()));
    }
    return found;
  };
  if ((block == 2 || block == 3 || block == 6) && rows.size % block == 0) {
    auto found = in_blocks_of(block);
    const double numbers = static_cast<double>(found.column.size()) * block * block;
    if (numbers <= most_filling * static_cast<double>(rows.start[rows.size])) return found;
  }
  return in_blocks_of(1);
}

SinglePrecisionMatrix::SinglePrecisionMatrix(Mat matrix, int block)
    : rows_(block_rows(matrix, block)), unit_(unit_of(matrix)) {
  numbers_.resize(rows_.column.size() * rows_.block * rows_.block + spare);
  copy_numbers(matrix);
}

void SinglePrecisionMatrix::copy_numbers(Mat matrix) {
  const RowReader rows(matrix);
  const double factor = 1.0 / unit_;
  std::fill(numbers_.begin(), numbers_.end(), 0.0F);
  with_block(rows_.block, [&](auto size) {
    constexpr int B = size();
    for (std::int32_t i = 0; i < rows_.size(); ++i)
      for (int r = 0; r < B; ++r) {
        std::int32_t place = rows_.start[i];
        for (PetscInt j = rows.start[i * B + r]; j < rows.start[i * B + r + 1]; ++j) {
          const PetscInt column = rows.column[j] / B, c = rows.column[j] % B;
          while (rows_.column[place] != column) // both ascend
            ++place;
          numbers_[(static_cast<std::size_t>(place) * B + c) * B + r] = static_cast<float>(factor * rows.number[j]);
        }
      }
  });
}

void SinglePrecisionMatrix::multiply(const double* x, double* y) const {
  multiply_blocks(rows_, numbers_.data(), unit_, false, x, y);
}

void SinglePrecisionMatrix::multiply_add(const double* x, double* y) const {
  multiply_blocks(rows_, numbers_.data(), unit_, true, x, y);
}

SinglePrecisionFactors::SinglePrecisionFactors(Mat matrix, int block) : unit_(unit_of(matrix)) {
  const BlockRows rows = block_rows(matrix, block);
  source_ = cuthill_mckee(rows);
  target_.resize(source_.size());
  for (std::size_t i = 0; i < source_.size(); ++i)
    target_[source_[i]] = static_cast<std::int32_t>(i);
  lower_.block = rows.block;
  lower_.start.push_back(0);
  for (std::int32_t i = 0; i < rows.size(); ++i) {
    for (std::int32_t j = rows.start[source_[i]]; j < rows.start[source_[i] + 1]; ++j)
      if (target_[rows.column[j]] < i) lower_.column.push_back(target_[rows.column[j]]);
    std::sort(lower_.column.begin() + lower_.start.back(), lower_.column.end());
    lower_.start.push_back(static_cast<std::int32_t>(lower_.column.size()));
  }
  const std::size_t entries = static_cast<std::size_t>(lower_.block) * lower_.block;
  numbers_.resize(lower_.column.size() * entries + spare);
  inverse_.resize(source_.size() * entries + spare);
  work_.resize(2 * source_.size() * (lower_.block == 3 ? padded<3> : lower_.block));
}

bool SinglePrecisionFactors::factorize(Mat matrix) {
  constexpr double first_shift = 1e-3, largest_shift = 1e3;
  for (shift_ = 0.0; shift_ < largest_shift; shift_ = std::max(first_shift, 4.0 * shift_))
    if (with_block(lower_.block, [&](auto size) { return try_to_factorize<size()>(matrix, shift_); })) return true;
  return false;
}

/// Row by row: L_ik = A_ik - sum over j < k of L_ij D_j⁻¹ L_kjᵀ, D_i = A_ii - sum over k of L_ik D_k⁻¹ L_ikᵀ, where the
/// matrix has blocks.
template <int B>
bool SinglePrecisionFactors::try_to_factorize(Mat matrix, double shift) {
  using Block = std::array<double, B * B>; // row by row
  /// left -= right * otherᵀ, other of single precision.
  const auto subtract = [](Block& left, const Block& right, const float* other) {
    for (int r = 0; r < B; ++r)
      for (int m = 0; m < B; ++m)
        for (int c = 0; c < B; ++c)
          left[r * B + c] -= right[r * B + m] * static_cast<double>(other[c * B + m]);
  };
  const auto stored = [](std::vector<float>& numbers, std::int32_t e) {
    return numbers.data() + static_cast<std::size_t>(e) * B * B;
  };
  const RowReader rows(matrix);
  const double factor = 1.0 / unit_;
  std::vector<std::int32_t> at(source_.size(), -1); // block column -> its place in the present row
  std::vector<Block> blocks, scaled;                // of the present row: A_ij, then L_ij; L_ij D_j⁻¹
  for (std::int32_t i = 0; i < lower_.size(); ++i) {
    const std::int32_t begin = lower_.start[i], end = lower_.start[i + 1];
    for (std::int32_t e = begin; e < end; ++e)
      at[lower_.column[e]] = e - begin;
    Block diagonal{};
    blocks.assign(end - begin, Block{});
    scaled.assign(end - begin, Block{});
    for (int r = 0; r < B; ++r)
      for (PetscInt j = rows.start[source_[i] * B + r]; j < rows.start[source_[i] * B + r + 1]; ++j) {
        const std::int32_t k = target_[rows.column[j] / B];
        if (k <= i) (k < i ? blocks[at[k]] : diagonal)[r * B + rows.column[j] % B] = factor * rows.number[j];
      }
    for (int r = 0; r < B; ++r)
      complete_pivot(diagonal[r * B + r], shift);
    for (std::int32_t e = begin; e < end; ++e) {
      const std::int32_t k = lower_.column[e];
      Block& block = blocks[e - begin];
      for (std::int32_t f = lower_.start[k]; f < lower_.start[k + 1]; ++f)
        if (const std::int32_t j = at[lower_.column[f]]; j >= 0) subtract(block, scaled[j], stored(numbers_, f));
      std::copy(block.begin(), block.end(), stored(numbers_, e));
      for (auto& number : block)
        number = -number;
      subtract(scaled[e - begin], block, stored(inverse_, k)); // which is its own transpose
      subtract(diagonal, scaled[e - begin], stored(numbers_, e));
    }
    for (std::int32_t e = begin; e < end; ++e)
      at[lower_.column[e]] = -1;
    if (!invert<B>(diagonal)) return false;
    std::copy(diagonal.begin(), diagonal.end(), stored(inverse_, i));
  }
  return true;
}

void SinglePrecisionFactors::solve(const double* b, double* x) const {
  substitute_blocks({lower_, source_.data(), numbers_.data(), inverse_.data(), unit_, work_.data()}, b, x);
}

} // namespace amontons
