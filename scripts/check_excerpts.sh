#!/bin/sh
# Compiles each C and C++ excerpt of docs/c-api.md in a function of its own, after the declarations that all share.
#
#   scripts/check_excerpts.sh INCLUDE_FOLDER WORK_FOLDER
set -eu
cd "$(dirname "$0")/.."

include=$1
out=$2/excerpts
mkdir -p "$out"

# Writes every block of a language as a function; #line makes the compiler's messages point into the document.
blocks() {
    awk -v fence="\`\`\`$1" -v open="$2" '
        $0 == fence { on = 1; n += 1; printf open "\n#line %d \"docs/c-api.md\"\n", n, NR + 1; next }
        /^```/ && on { on = 0; print "}"; next }
        on { if ($0 !~ /^#include/) { sub(/^static /, ""); print } else print "" }' docs/c-api.md
}

# Excerpts use these without saying where they come from. Functions in excerpts are GNU C's nested ones.
{
    cat <<'END'
#include <etendue.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
extern etd_device *device; extern etd_scene *scene; extern etd_film *film; extern etd_task *task;
extern uint32_t mesh, floor_, ball, red, faces;
extern float *positions; extern uint32_t *indices; extern size_t vertex_count, triangle_count;
struct viewer; extern struct viewer *viewer;
void check(etd_status status);
void show(const float *pixels, uint32_t width, uint32_t height);
void viewer_wake(struct viewer *viewer);
int viewer_closed(struct viewer *viewer);
void show_part(uint32_t number, const double *points, size_t count);
struct pool; extern struct pool *pool;
void pool_push(struct pool *pool, void (*work)(void *), void *argument);
END
    blocks c 'void excerpt_%d(void) {'
} >"$out/excerpts.c"
grep -q '^void excerpt_5' "$out/excerpts.c" || { echo "docs/c-api.md: the excerpts were not found" >&2; exit 1; }
# gcc alone has nested functions.
gcc -std=gnu11 -Wall -Wextra -Werror -Wno-unused-variable -Wno-unused-but-set-variable -Wno-unused-function -Wno-unused-parameter \
    -fsyntax-only -I"$include" "$out/excerpts.c"

if [ -f "$include/etendue.hpp" ]; then
    {
        printf '#include <etendue.hpp>\n#include <cstdio>\n#include <vector>\n'
        blocks cpp 'void excerpt_%d() {'
    } >"$out/excerpts.cpp"
    "${CXX:-c++}" -std=c++17 -Wall -Wextra -Werror -Wno-unused-variable -fsyntax-only -I"$include" "$out/excerpts.cpp"
fi
