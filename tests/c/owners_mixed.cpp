// A file with exceptions beside one without (owners_plain.cpp): each keeps its own setting.
#define JCAS_EXCEPTIONS
#include <cstdio>
#include <jcas.hpp>

bool plain_refuses();

int main()
{
    bool thrown = false;
    try {
        jcas::configuration_from_toml("quorum = 0").take();
    } catch (const jcas::error &error) {
        thrown = error.code() == JCAS_ERROR_CONFIG;
    }
    if (!thrown || !plain_refuses())
        return 1;
    std::puts("both kinds live in one program");
    return 0;
}
