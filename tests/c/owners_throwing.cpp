// The same with exceptions asked for.
#define WITH_EXCEPTIONS
#include "owners.cpp"
