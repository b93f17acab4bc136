// Compiled once: the JSON schema of scenes as files.
#include "exported.hpp"

#include "rbdyn/file/schema.ipp"
