#pragma once
// What this machine can do at most, on one core, measured: what stages are compared with.

namespace heartservo::bench {

struct MachineLimit {
  const char* instructions = "";  ///< widest set that Highway picks here
  double gflops = 0;              ///< multiply-adds on independent registers, 2 operations each
  double gather_ns = 0;           ///< one 32-bit word by gather instructions out of 64 KiB, neighbours next to each other
  double load_ns = 0;             ///< the same, each word loaded by itself
  double word_ns() const { return gather_ns < load_ns ? gather_ns : load_ns; }
  double read_gb_s = 0;           ///< from memory, 256 MiB read once
};

MachineLimit measure_machine();

/// CPU time of the whole process, s: a machine that is busy with other things does not count.
double cpu_s();
/// CPU time of this thread, s.
double thread_cpu_s();

}  // namespace heartservo::bench
