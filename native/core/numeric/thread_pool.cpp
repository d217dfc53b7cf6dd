// SPDX-License-Identifier: GPL-3.0-or-later
#include "numeric/thread_pool.hpp"

#include <system_error>

namespace lamina {

ThreadPool::ThreadPool(unsigned threads) {
  const unsigned hardware = std::max(1U, std::thread::hardware_concurrency());
  const unsigned wanted = threads == 0 ? hardware : threads;
  workers_.reserve(wanted - 1);
  try {
    for (unsigned i = 1; i < wanted; ++i) {
      workers_.emplace_back([this] { work(); });
    }
  } catch (const std::system_error&) {
    // The system has no more threads. Results do not depend on their number.
  }
}

ThreadPool::~ThreadPool() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  for (std::thread& worker : workers_) {
    worker.join();
  }
}

void ThreadPool::run(std::size_t count, const std::function<void(std::size_t)>& task) {
  const std::lock_guard whole_run(one_run_);
  {
    const std::lock_guard lock(mutex_);
    task_ = &task;
    count_ = count;
    next_ = 0;
    failure_ = nullptr;
    ++run_number_;
  }
  wake_.notify_all();
  drain();
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return active_ == 0 && next_ >= count_; });
  task_ = nullptr;
  if (stopped_) {
    throw Stopped();
  }
  if (failure_) {
    std::rethrow_exception(failure_);
  }
}

void ThreadPool::work() {
  std::size_t seen = 0;
  while (true) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return stopping_ || run_number_ != seen; });
      if (stopping_) {
        return;
      }
      seen = run_number_;
    }
    drain();
  }
}

void ThreadPool::drain() {
  std::unique_lock lock(mutex_);
  while (task_ != nullptr && next_ < count_) {
    if (stopped_) {
      next_ = count_;
      break;
    }
    const std::size_t index = next_++;
    const auto* task = task_;
    ++active_;
    lock.unlock();
    std::exception_ptr failure;
    try {
      (*task)(index);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    --active_;
    if (failure && (!failure_ || index < failed_task_)) {
      failure_ = failure;
      failed_task_ = index;
    }
  }
  if (active_ == 0) {
    done_.notify_all();
  }
}

}  // namespace lamina
