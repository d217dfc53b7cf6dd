// SPDX-License-Identifier: GPL-3.0-or-later
// Runs independent tasks on a fixed number of threads.
#pragma once
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace lamina {

/// Runs independent tasks on a fixed number of threads. Each task writes to memory of its own, and callers sum in task
/// order afterwards, so that results do not depend on the number of threads.
class ThreadPool {
 public:
  /// `threads` 0: one per hardware thread. The calling thread is one of them.
  explicit ThreadPool(unsigned threads = 0);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  unsigned threads() const { return static_cast<unsigned>(workers_.size()) + 1; }

  /// Calls task(0) ... task(count - 1) and returns when all are done. Rethrows the exception of the lowest task that
  /// threw. Throws Stopped after stop(). Must not be called from inside a task.
  void run(std::size_t count, const std::function<void(std::size_t)>& task);

  struct Stopped : std::exception {
    const char* what() const noexcept override { return "the work was stopped"; }
  };
  /// From another thread: run() begins no further task, now or later, and throws Stopped.
  void stop() { stopped_ = true; }

 private:
  void work();
  void drain();

  std::vector<std::thread> workers_;
  std::mutex mutex_;
  std::mutex one_run_;
  std::condition_variable wake_;
  std::condition_variable done_;
  const std::function<void(std::size_t)>* task_ = nullptr;
  std::size_t count_ = 0;
  std::size_t next_ = 0;
  std::size_t active_ = 0;
  std::size_t run_number_ = 0;
  bool stopping_ = false;
  std::atomic<bool> stopped_ = false;
  std::size_t failed_task_ = 0;
  std::exception_ptr failure_;
};

}  // namespace lamina
