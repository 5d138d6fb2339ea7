// This program repeats owners.cpp with exceptions.
#define WITH_EXCEPTIONS
#include "owners.cpp"
