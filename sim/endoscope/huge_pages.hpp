#pragma once
#include <sys/mman.h>

#include <cstddef>
#include <new>

namespace heartservo::sim {

/// For large tables that are read all over: asks the kernel for pages of 2 MiB, so that looking addresses up does not
/// take longer than reading. Where there are none, ordinary pages do.
template <class T>
struct HugePageAllocator {
  using value_type = T;
  HugePageAllocator() = default;
  template <class U>
  HugePageAllocator(const HugePageAllocator<U>&) {}

  T* allocate(std::size_t n) {
    constexpr std::size_t kPage = std::size_t{2} << 20;
    const std::size_t bytes = (n * sizeof(T) + kPage - 1) / kPage * kPage;
    void* const memory = ::operator new(bytes, std::align_val_t{kPage});
    (void)madvise(memory, bytes, MADV_HUGEPAGE);  // refused: as before, only slower
    return static_cast<T*>(memory);
  }
  void deallocate(T* p, std::size_t) { ::operator delete(p, std::align_val_t{std::size_t{2} << 20}); }
  template <class U>
  bool operator==(const HugePageAllocator<U>&) const {
    return true;
  }
};

}  // namespace heartservo::sim
