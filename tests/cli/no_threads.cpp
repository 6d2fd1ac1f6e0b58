// SPDX-License-Identifier: GPL-3.0-or-later
// For LD_PRELOAD: a system that gives MILLPOSE_THREADS threads and then none.
#include <dlfcn.h>
#include <pthread.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

// The C library's own, which this one stands in for.
extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*work)(void*),
                              void* argument) {
  using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  static const Create create = reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"));
  static std::atomic<int> left = std::atoi(std::getenv("MILLPOSE_THREADS"));
  return left-- > 0 ? create(thread, attributes, work, argument) : EAGAIN;
}
