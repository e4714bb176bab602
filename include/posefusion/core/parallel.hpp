// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <cstddef>
#include <optional>
#include <utility>

namespace pf {

/// Rows of an image or of a grid that a thread takes at a time.
constexpr std::size_t kRowsAtOnce = 8;

/// Calls body(begin, end) on pieces of [0, count) of about `grain` items, in parallel. The body
/// must write only what its own items own, so that the number of threads cannot change the result.
template <typename Body>
void parallelFor(std::size_t count, std::size_t grain, const Body& body) {
  if (count == 0) return;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, grain),
      [&](const tbb::blocked_range<std::size_t>& r) { body(r.begin(), r.end()); },
      tbb::simple_partitioner());
}

/// What work() returns, without help from other threads: for what runs beside, and must not take
/// the cores of what cannot wait.
template <typename Work>
auto inOneThread(const Work& work) {
  // Not by what execute() returns: where work() throws, TBB 2020 destroys a result that there is
  // not.
  std::optional<decltype(work())> result;
  tbb::task_arena(1).execute([&] { result.emplace(work()); });
  return std::move(*result);
}

/// Sum of body(begin, end) over pieces of [0, count): the pieces and the order of the additions
/// depend on count and grain alone, so the bits are the same for any number of threads.
/// Sum needs a default value that is zero and operator+=.
template <typename Sum, typename Body>
Sum deterministicSum(std::size_t count, std::size_t grain, const Body& body) {
  if (count == 0) return Sum{};
  return tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, count, grain), Sum{},
      [&](const tbb::blocked_range<std::size_t>& r, Sum sum) {
        sum += body(r.begin(), r.end());
        return sum;
      },
      [](Sum a, const Sum& b) {
        a += b;
        return a;
      },
      tbb::simple_partitioner());
}

}  // namespace pf

/// Compiles the function once per instruction set and picks at run time. Only for kernels on plain
/// arrays: code that touches Eigen, PCL or Ceres types must not be compiled twice (see
/// docs/algorithm.md, "Speed"). Results agree to the bit, because -ffp-contract=off holds for all.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(POSEFUSION_NO_CLONES)
#define POSEFUSION_SIMD_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define POSEFUSION_SIMD_CLONES
#endif
