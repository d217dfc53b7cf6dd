# SPDX-License-Identifier: GPL-3.0-or-later
# Windows on x86-64. Python's headers define MS_WIN64 for Microsoft's compiler only.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(zig_target x86_64-windows-gnu)
set(CMAKE_CXX_FLAGS_INIT -DMS_WIN64)
include(${CMAKE_CURRENT_LIST_DIR}/zig.cmake)
