#pragma once
/// Deterministic parallel loops: each index writes its own output, reductions are made afterwards in index order, so
/// the same input gives the same bytes for any number of threads.

#include <cstddef>
#include <functional>

namespace pellicle {

/// Calls `body(begin, end)` for disjoint ranges that cover [0, n). Ranges may run on any thread, in any order.
/// \param grain smallest range worth a task.
void parallel_for(std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

/// Limits every later parallel_for of the process to this many threads (0 = all cores) for the object's lifetime.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  void* control_;
};

}  // namespace pellicle
