/* Tilescope's planes for programs in C and C++: maximal Poisson-disk samples of any window of an endless plane.
 *
 * No two samples lie within the radius, and no place farther than (1 + 2^-15) radii from a sample. Equal settings give equal
 * samples, bit for bit, on every machine, in every window: a sample's two numbers can serve as its name.
 *
 * Every function may be called from several threads at once, also for the same plane. A plane is freed once, when no call uses
 * it any longer. README.md says how to build and link the library.
 */
#ifndef TILESCOPE_H
#define TILESCOPE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What became of a call. After any value but TILESCOPE_OK, tilescope_message() says why in a sentence. */
typedef int32_t TilescopeStatus;
enum {
    TILESCOPE_OK = 0,
    /* A pointer is null or not aligned. */
    TILESCOPE_BAD_POINTER = 1,
    /* A setting or a window is not one that can be sampled; the message names the value and the limit. */
    TILESCOPE_BAD_VALUE = 2,
    /* The samples are more than the buffer holds. Nothing was written but the number of samples. */
    TILESCOPE_TOO_SMALL = 3,
    /* The samples could not be made, for lack of memory for instance. */
    TILESCOPE_FAILED = 4,
    /* A fault of the library. The plane can still be used and freed. */
    TILESCOPE_PANIC = 5
};

/* How samples are made. */
enum {
    /* Tiling of samples, elimination and insertion (Wang and Suda 2017): the fastest. */
    TILESCOPE_KDRT = 0,
    /* Tiling of darts with their order of arrival: seams leave no trace in the statistics. Moves take about 50 times as long. */
    TILESCOPE_EXACT = 1
};

/* What a plane is made from. Begin with tilescope_settings(), and change what you want to. */
typedef struct TilescopeSettings {
    uint64_t seed;
    /* No two samples are closer than this. Above 0, in your units. */
    double radius;
    /* After this distance the plane repeats, along x and along y: 10 to 65,532 radii, or 0 for 65,000 radii. */
    double period;
    /* The shortest edge of a block in radii, at least 6, or 0 for 30. Larger ones are faster. */
    double leaf;
    /* TILESCOPE_KDRT or TILESCOPE_EXACT. */
    int32_t method;
} TilescopeSettings;

/* A rectangle of the plane: left <= x < right and bottom <= y < top. It is at most one period wide and high, and begins at most
 * 1,000 periods from 0. Windows that share an edge share no sample. */
typedef struct TilescopeWindow {
    double left;
    double bottom;
    double right;
    double top;
} TilescopeWindow;

typedef struct TilescopePoint {
    double x;
    double y;
} TilescopePoint;

/* A plane, whose samples are made window by window. */
typedef struct TilescopePlane TilescopePlane;

/* Returns the usual settings: seed 1, radius 1, period 0, leaf 0, method TILESCOPE_KDRT. */
TilescopeSettings tilescope_settings(void);

/* Makes a plane and stores it in *plane: free it by tilescope_plane_free(). After a failure *plane is null. The first plane of a
 * program takes about 20 milliseconds, with TILESCOPE_EXACT half a second, as its pattern is made. */
TilescopeStatus tilescope_plane_new(const TilescopeSettings *settings, TilescopePlane **plane);

/* Frees a plane. Null is allowed. */
void tilescope_plane_free(TilescopePlane *plane);

/* Stores the most samples that a window can have, whatever the settings' seed: a buffer of so many points always suffices, for
 * the window and for what it gains by moves. */
TilescopeStatus tilescope_plane_capacity(const TilescopePlane *plane, const TilescopeWindow *window, size_t *capacity);

/* Writes the samples in a window to points[0] and on, and their number to *count.
 *
 * points may be null if capacity is 0. If there are more samples than capacity, the status is TILESCOPE_TOO_SMALL, *count says
 * how many there are, and points is left alone. After any other failure *count is 0. Equal calls give an equal order. */
TilescopeStatus tilescope_plane_window(const TilescopePlane *plane, const TilescopeWindow *window, TilescopePoint *points,
                                       size_t capacity, size_t *count);

/* Writes the samples that lie in the window `to` and not in the window `from`: what a window gains when it moves. Only the strips
 * of `to` beyond `from` are computed. Otherwise as tilescope_plane_window(). */
TilescopeStatus tilescope_plane_gained(const TilescopePlane *plane, const TilescopeWindow *from, const TilescopeWindow *to,
                                       TilescopePoint *points, size_t capacity, size_t *count);

/* Writes the samples that lie in the window `from` and not in the window `to`: what a window loses when it moves. Who keeps the
 * samples at hand is faster by tilescope_plane_contains(). Otherwise as tilescope_plane_window(). */
TilescopeStatus tilescope_plane_lost(const TilescopePlane *plane, const TilescopeWindow *from, const TilescopeWindow *to,
                                     TilescopePoint *points, size_t capacity, size_t *count);

/* Stores whether a sample lies in a window. Comparing its numbers with the window's may answer otherwise for a sample on an edge,
 * since windows begin and end on the lattice of 2^-15 radii on which samples lie. */
TilescopeStatus tilescope_plane_contains(const TilescopePlane *plane, const TilescopeWindow *window, TilescopePoint point,
                                         bool *is_inside);

/* Returns why the last call that failed on this thread did, in UTF-8, and an empty text before that. The text lives until the
 * next failure on this thread. */
const char *tilescope_message(void);

/* Returns the version of the library, such as "0.1.0". */
const char *tilescope_version(void);

#ifdef __cplusplus
}
#endif

#endif
