// The two forms of the library: its definitions are compiled once, in the library that a program links (rbdyn::rbdyn,
// rbdyn::core), or stand in the headers of every file that includes rbdyn/rbdyn.hpp (rbdyn::header_only). The names of
// each live in an inline namespace of their own, so that files of both forms in one program do not link by mistake.
#pragma once

#if !defined(RBDYN_HEADER_ONLY)
#define RBDYN_FORM compiled
#define RBDYN_INLINE
#elif defined(RBDYN_WITH_SUNDIALS)
#define RBDYN_FORM header_only_with_sundials
#define RBDYN_INLINE inline
#else
#define RBDYN_FORM header_only
#define RBDYN_INLINE inline
#endif
