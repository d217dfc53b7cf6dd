# SPDX-License-Identifier: GPL-3.0-or-later
# What the toolchain files of all platforms share: zig as compiler, archiver and linker. The file that includes this one
# sets CMAKE_SYSTEM_NAME, CMAKE_SYSTEM_PROCESSOR and zig_target. The environment variable LAMINA_ZIG is zig's path.
set(zig $ENV{LAMINA_ZIG})
if(NOT EXISTS "${zig}")
  message(FATAL_ERROR "LAMINA_ZIG = '${zig}': must be the path of zig (release/build.py sets it)")
endif()
# zig compiles its C++ library for each set of options that it is linked with, for minutes: -O3 and -s (no symbols) are
# given to every command, CMake's trials too, so that there is one set. The modules' symbols are thereby left out.
set(CMAKE_C_COMPILER ${zig} cc -target ${zig_target} -O3 -s)
set(CMAKE_CXX_COMPILER ${zig} c++ -target ${zig_target} -O3 -s)
set(CMAKE_STRIP true)
foreach(language C CXX)
  set(CMAKE_${language}_ARCHIVE_CREATE "${zig} ar qc <TARGET> <OBJECTS>")
  set(CMAKE_${language}_ARCHIVE_APPEND "${zig} ar q <TARGET> <OBJECTS>")
  set(CMAKE_${language}_ARCHIVE_FINISH "${zig} ranlib <TARGET>")
endforeach()

# Headers and libraries of this machine are not the target's. Eigen has headers only, and pybind11 is named by its path.
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
