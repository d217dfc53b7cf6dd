# SPDX-License-Identifier: GPL-3.0-or-later
# macOS 11 or newer on Apple's processors. release/libcxx.py reads the inline namespace of the C++ library.
set(libcxx_namespace __lamina)
set(CMAKE_SYSTEM_NAME Darwin)
set(CMAKE_SYSTEM_PROCESSOR arm64)
set(zig_target aarch64-macos.11.0)
include(${CMAKE_CURRENT_LIST_DIR}/zig.cmake)
