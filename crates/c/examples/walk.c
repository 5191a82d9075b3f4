/* A viewer walks over an endless plane. The samples around him, say trees, are kept in an array: those that he leaves behind go,
 * those that come into view are added. In the end they are exactly the samples of his last window.
 *
 *   cc -std=c99 -I crates/c crates/c/examples/walk.c -L target/release -ltilescope_c -Wl,-rpath,target/release -o walk
 *   ./walk          prints how many samples came and went
 *   ./walk points   prints the last samples, as the bits of x and y
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tilescope.h"

/* Steps of the walk, and the side of the window in steps. */
#define STEPS 150
#define SIDE 60

static void check(TilescopeStatus status)
{
    if (status != TILESCOPE_OK) {
        fprintf(stderr, "walk: %s\n", tilescope_message());
        exit(1);
    }
}

/* The window after some steps: to the right, and from the second third on also downwards, across the ends of the period. */
static TilescopeWindow window_after(int step, double radius)
{
    const double length = 2.0 * radius;
    const int down = step > STEPS / 3 ? step - STEPS / 3 : 0;
    TilescopeWindow window;
    window.left = -100.0 * radius + length * step;
    window.bottom = 50.0 * radius - length * down;
    window.right = window.left + SIDE * length;
    window.top = window.bottom + SIDE * length;
    return window;
}

static int by_row(const void *a, const void *b)
{
    const TilescopePoint *p = a, *q = b;
    if (p->y != q->y) {
        return p->y < q->y ? -1 : 1;
    }
    return (p->x > q->x) - (p->x < q->x);
}

static uint64_t bits(double number)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    return bits;
}

int main(int argc, char **argv)
{
    TilescopeSettings settings = tilescope_settings();
    settings.seed = 7;
    settings.radius = 1.5;

    TilescopePlane *plane;
    check(tilescope_plane_new(&settings, &plane));

    /* Room for the most samples that a window of this size can have: the walk needs no other. */
    TilescopeWindow window = window_after(0, settings.radius);
    size_t capacity, count;
    check(tilescope_plane_capacity(plane, &window, &capacity));
    TilescopePoint *trees = malloc(capacity * sizeof *trees);
    TilescopePoint *whole = malloc(capacity * sizeof *whole);
    if (trees == NULL || whole == NULL) {
        return 1;
    }
    check(tilescope_plane_window(plane, &window, trees, capacity, &count));

    size_t came = 0, went = 0;
    for (int step = 1; step <= STEPS; step++) {
        const TilescopeWindow next = window_after(step, settings.radius);

        /* First those that stay move together, so that there is room behind them. */
        size_t kept = 0;
        for (size_t k = 0; k < count; k++) {
            bool stays;
            check(tilescope_plane_contains(plane, &next, trees[k], &stays));
            if (stays) {
                trees[kept++] = trees[k];
            }
        }

        size_t gained;
        check(tilescope_plane_gained(plane, &window, &next, trees + kept, capacity - kept, &gained));
        came += gained;
        went += count - kept;
        count = kept + gained;
        window = next;
    }

    /* All of this must be what the last window has. */
    size_t expected;
    check(tilescope_plane_window(plane, &window, whole, capacity, &expected));
    qsort(trees, count, sizeof *trees, by_row);
    qsort(whole, expected, sizeof *whole, by_row);
    if (count != expected || memcmp(trees, whole, count * sizeof *trees) != 0) {
        fprintf(stderr, "walk: %zu samples were kept, and the window has %zu others\n", count, expected);
        return 1;
    }

    if (argc > 1 && strcmp(argv[1], "points") == 0) {
        for (size_t k = 0; k < count; k++) {
            printf("%016" PRIx64 " %016" PRIx64 "\n", bits(trees[k].x), bits(trees[k].y));
        }
    } else {
        printf("%zu samples in view after %d steps; %zu came, %zu went\n", count, STEPS, came, went);
    }

    free(whole);
    free(trees);
    tilescope_plane_free(plane);
    return 0;
}
