// See owners_mixed.cpp.
#include <jcas.hpp>

bool plain_refuses()
{
    auto config = jcas::configuration_from_toml("quorum = 0");
    return !config && config.message().find("quorum = 0") != std::string::npos;
}
