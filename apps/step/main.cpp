// SPDX-License-Identifier: GPL-3.0-or-later
// millpose-step FORMAT CHORD_MM MEMORY_MB SECONDS: STEP, IGES or 3MF on stdin, triangles on stdout
// (lib/geometry/import/step_reader.hpp). Lines "progress PERCENT" on stderr. Exit status 2: the file cannot
// be read (why on stderr); 3: out of memory. Signals end it at its other limits, and with its parent.
#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Standard_Failure.hxx>
#include <Standard_OutOfMemory.hxx>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <iterator>
#include <new>
#include <string>

#include "base/process.hpp"
#include "base/text.hpp"
#include "geometry/import/step_reader.hpp"
#include "iges_file.hpp"
#include "step_file.hpp"
#include "tessellate.hpp"
#include "threemf_file.hpp"

namespace {

constexpr int kOutOfMemory = 3;

void Limit(int resource, rlim_t most) {
  const rlimit limit{most, most};
  ::setrlimit(static_cast<__rlimit_resource>(resource), &limit);
}

bool Write(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    if (count <= 0) return false;
    bytes.remove_prefix(static_cast<size_t>(count));
  }
  return true;
}

// OpenCASCADE lets allocations fail where nobody can catch.
[[noreturn]] void Terminate() {
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    ::_exit(kOutOfMemory);
  } catch (const Standard_OutOfMemory&) {
    ::_exit(kOutOfMemory);
  } catch (...) {
  }
  std::abort();
}

std::string Everything(std::istream& file) { return {std::istreambuf_iterator<char>(file), {}}; }

millpose::RawMesh ReadPart(millpose::CadFormat format, double chord_tolerance) {
  using millpose::CadFormat;
  if (format == CadFormat::kThreeMf) return millpose::ReadThreeMf(Everything(std::cin));
  return millpose::Tessellate(format == CadFormat::kIges ? millpose::ReadIgesModel(Everything(std::cin))
                                                         : millpose::ReadStepModel(std::cin),
                              chord_tolerance);
}

int Read(millpose::CadFormat format, double chord_tolerance) {
  // Whatever OpenCASCADE prints goes to stderr; stdout is for the answer.
  const int answer = ::dup(1);
  ::dup2(2, 1);
  Message::DefaultMessenger()->ChangePrinters().Clear();
  try {
    return Write(answer, millpose::WriteStepTriangles(ReadPart(format, chord_tolerance))) ? 0 : 1;
  } catch (const std::bad_alloc&) {
    return kOutOfMemory;
  } catch (const Standard_OutOfMemory&) {
    return kOutOfMemory;
  } catch (const Standard_Failure& failure) {
    std::fprintf(stderr, "the %s file cannot be read: %s\n", millpose::NameOf(format),
                 failure.GetMessageString());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
  }
  return 2;
}

}  // namespace

#if defined(MILLPOSE_SANITIZED)
// OpenCASCADE keeps what it allocated to the end.
extern "C" const char* __asan_default_options() { return "detect_leaks=0"; }
#endif

int main(int argc, char** argv) {
  const auto number = [&](int i) { return i < argc ? millpose::ParseNumber(argv[i]).value_or(0) : 0; };
  const std::string name = argc > 1 ? argv[1] : "";
  const auto* const format = std::ranges::find(millpose::kCadFormats, name, millpose::NameOf);
  const double chord = number(2), memory = number(3), seconds = number(4);
  if (argc != 5 || format == millpose::kCadFormats.end() || chord <= 0 || memory < 1 || seconds < 1) {
    std::fprintf(stderr, "usage: millpose-step STEP|IGES|3MF CHORD_MM MEMORY_MB SECONDS <FILE\n");
    return 1;
  }
  millpose::EndWithParent();
  std::set_new_handler([] { ::_exit(kOutOfMemory); });
  std::set_terminate(Terminate);
  Limit(RLIMIT_CORE, 0);
#if !defined(MILLPOSE_SANITIZED)  // the address sanitizer reserves terabytes
  Limit(RLIMIT_AS, static_cast<rlim_t>(memory) << 20);
#endif
  Limit(RLIMIT_CPU, static_cast<rlim_t>(seconds));
  ::alarm(static_cast<unsigned>(seconds) + 1);
  return Read(*format, chord);
}
