// Symbols of libwavepath.so, and the namespace of its interface.
#pragma once

#if defined(__GNUC__)
#define WAVEPATH_API __attribute__((visibility("default")))
#else
#define WAVEPATH_API
#endif

// The interface lives in a namespace of its version, so that two versions in one process do not meet. Programs write
// `wavepath`. (The sources of the library have a namespace of that name for what is inside.)
namespace wavepath_v0 {}
#ifndef WAVEPATH_LIBRARY_SOURCES
namespace wavepath = wavepath_v0;
#endif
