// The two forms of the library: its definitions are compiled once, in the library that a program links (rbdyn::rbdyn,
// rbdyn::core), or stand in the headers of every file that includes rbdyn/rbdyn.hpp (rbdyn::header_only). The names of
// each live in an inline namespace of their own, so that functions of one form are not called from files of the other.
// So do those of files whose standard containers are checked, which are of other types (_GLIBCXX_DEBUG).
#pragma once

#if !defined(RBDYN_HEADER_ONLY) && defined(_GLIBCXX_DEBUG)
#define RBDYN_FORM compiled_with_debug_containers
#define RBDYN_INLINE
#elif !defined(RBDYN_HEADER_ONLY)
#define RBDYN_FORM compiled
#define RBDYN_INLINE
#elif defined(RBDYN_WITH_SUNDIALS)
#define RBDYN_FORM header_only_with_sundials
#define RBDYN_INLINE inline
#else
#define RBDYN_FORM header_only
#define RBDYN_INLINE inline
#endif
