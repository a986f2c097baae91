/* Hand-written reference of ensembles: blocks of 32 members, in loops that the compiler turns into vectors.

   Build: cc -O3 -march=native -ffp-contract=fast -fno-math-errno -fopenmp-simd -shared -fPIC ensemble.c -o ensemble.so
   -lm. Momenta in units of the displacement, rows of two; poses, rows of four, may be NULL. Both are replaced by the
   last ones. Two corrections are made in registers; a member that needs more gets them alone. Returns the number of
   members whose root is not certain to be the principal one, which this reference does not follow. */

#include <math.h>
#include <string.h>

#define LANES 32
#define LANE for (int j = 0; j < LANES; j++)
#define SIMD _Pragma("omp simd")
#define CONVERGED(d1, d2, y1, y2) (d1 * d1 + d2 * d2 <= 1e-18 * (1 + y1 * y1 + y2 * y2))

typedef double lanes[LANES] __attribute__((aligned(64)));

typedef struct {
    lanes m1, m2, k1, k2, y1, y2, u1, u2, v1, v2, q0, q1, q2, q3, n1, n2, l1, l2, w1, w2, open;
} block;

static inline void kahan(double total, double lost, double term, double *result, double *rest) {
    double change = term - lost, sum = total + change;
    *rest = (sum - total) - change;
    *result = sum;
}

static inline void top_correction(const double *b, double m1, double m2, double y1, double y2, double *d1, double *d2) {
    double s = b[4] * y1 - b[3] * y2, weight = 1 + y1 * y1 + y2 * y2;
    double g1 = b[0] * y1 + b[1] * y2 - s * y2 - weight * m1, g2 = b[1] * y1 + b[2] * y2 + s * y1 - weight * m2;
    double j11 = b[0] - b[4] * y2 - 2 * y1 * m1, j12 = b[1] + b[3] * y2 - s - 2 * y2 * m1;
    double j21 = b[1] + b[4] * y1 + s - 2 * y1 * m2, j22 = b[2] - b[3] * y1 - 2 * y2 * m2;
    double inverse = 1 / (j11 * j22 - j12 * j21);
    *d1 = (j12 * g2 - j22 * g1) * inverse;
    *d2 = (j21 * g1 - j11 * g2) * inverse;
}

static inline void top_increment(const double *b, double m1, double m2, double y1, double y2, double *d1, double *d2) {
    (void)m1, (void)m2;
    double push = 2 * (b[4] * y1 - b[3] * y2) / (1 + y1 * y1 + y2 * y2);
    *d1 = push * y2;
    *d2 = -push * y1;
}

static inline int top_certified(const double *b, double m1, double m2, double y1, double y2) {
    (void)m1, (void)m2;
    return y1 * y1 + y2 * y2 <= b[5];
}

static inline void top_move(double y1, double y2, double *q0, double *q1, double *q2, double *q3) {
    double z0 = 1 / sqrt(1 + y1 * y1 + y2 * y2), x = -y2 * z0, y = y1 * z0;
    double r0 = *q0 * z0 - *q1 * x - *q2 * y, r1 = *q0 * x + *q1 * z0 - *q3 * y;
    double r2 = *q0 * y + *q2 * z0 + *q3 * x, r3 = *q3 * z0 + *q1 * y - *q2 * x;
    double unit = (3 - (r0 * r0 + r1 * r1 + r2 * r2 + r3 * r3)) / 2;
    *q0 = r0 * unit, *q1 = r1 * unit, *q2 = r2 * unit, *q3 = r3 * unit;
}

/* body = (m, J, a); y = (t, half the slide over cos) */
static inline double slide(const double *b, double m2, double t) {
    return (m2 * (1 + t * t) + 2 * b[2] * b[0] * t * t) / (2 * b[0]);
}

static inline double slope(const double *b, double m1, double m2, double t) {
    double hat = b[2] * (m2 + 2 * b[0] * b[2]);
    return (3 * hat * t - 2 * m1) * t + 2 * b[1] + hat;
}

static inline void sleigh_correction(const double *b, double m1, double m2, double t, double y2, double *d1, double *d2) {
    double hat = b[2] * (m2 + 2 * b[0] * b[2]);
    double f = ((hat * t - m1) * t + 2 * b[1] + hat) * t - m1;
    *d1 = -f / slope(b, m1, m2, t);
    *d2 = slide(b, m2, t + *d1) - y2;
}

static inline void sleigh_increment(const double *b, double m1, double m2, double t, double y2, double *d1, double *d2) {
    (void)m1, (void)m2;
    double weight = 4 * b[2] * b[0] * t / (1 + t * t);
    *d1 = -weight * y2;
    *d2 = weight * t;
}

static inline int sleigh_certified(const double *b, double m1, double m2, double t, double y2) {
    (void)y2;
    return (slope(b, m1, m2, t) >= 0) & (t * t <= 3) & (t * m1 >= 0);
}

static inline void sleigh_move(double t, double y2, double *q0, double *q1, double *q2, double *q3) {
    double scale = 1 / (1 + t * t), c = (1 - t * t) * scale, s = 2 * t * scale, along = 2 * y2 * scale;
    double across = t * along;
    *q2 += *q0 * along - *q1 * across;
    *q3 += *q1 * along + *q0 * across;
    double r0 = *q0 * c - *q1 * s, r1 = *q1 * c + *q0 * s, unit = (3 - (r0 * r0 + r1 * r1)) / 2;
    *q0 = r0 * unit, *q1 = r1 * unit;
}

/* The loops, once for each system. */
#define SYSTEM(name)                                                                                                   \
    static long name##_solve(const double *b, block *s) {                                                              \
        long left = 0, uncertain = 0;                                                                                  \
        SIMD LANE {                                                                                                    \
            double d1, d2, w1 = s->w1[j], w2 = s->w2[j];                                                               \
            name##_correction(b, s->n1[j], s->n2[j], w1, w2, &d1, &d2);                                                \
            w1 += d1, w2 += d2;                                                                                        \
            name##_correction(b, s->n1[j], s->n2[j], w1, w2, &d1, &d2);                                                \
            w1 += d1, w2 += d2;                                                                                        \
            s->w1[j] = w1, s->w2[j] = w2;                                                                              \
            s->open[j] = CONVERGED(d1, d2, w1, w2) & name##_certified(b, s->n1[j], s->n2[j], w1, w2) ? 0.0 : 1.0;      \
        }                                                                                                              \
        LANE left += s->open[j] != 0.0;                                                                                \
        if (left == 0) return 0;                                                                                       \
        LANE if (s->open[j] != 0.0) {                                                                                  \
            double d1 = 1, d2 = 1;                                                                                     \
            for (int i = 0; i < 6 && !CONVERGED(d1, d2, s->w1[j], s->w2[j]); i++) {                                    \
                name##_correction(b, s->n1[j], s->n2[j], s->w1[j], s->w2[j], &d1, &d2);                                \
                s->w1[j] += d1, s->w2[j] += d2;                                                                        \
            }                                                                                                          \
            uncertain += !name##_certified(b, s->n1[j], s->n2[j], s->w1[j], s->w2[j]);                                 \
        }                                                                                                              \
        return uncertain;                                                                                              \
    }                                                                                                                  \
    long name(const double *b, double *m, double *q, long members, long steps) {                                       \
        block s;                                                                                                       \
        long uncertain = 0;                                                                                            \
        for (long first = 0; first + LANES <= members; first += LANES) {                                               \
            memset(&s, 0, sizeof s);                                                                                   \
            LANE {                                                                                                     \
                s.n1[j] = m[2 * (first + j)], s.n2[j] = m[2 * (first + j) + 1];                                        \
                if (q) {                                                                                               \
                    double *pose = q + 4 * (first + j);                                                                \
                    s.q0[j] = pose[0], s.q1[j] = pose[1], s.q2[j] = pose[2], s.q3[j] = pose[3];                        \
                }                                                                                                      \
            }                                                                                                          \
            uncertain += name##_solve(b, &s);                                                                          \
            LANE {                                                                                                     \
                s.m1[j] = s.n1[j], s.m2[j] = s.n2[j];                                                                  \
                s.y1[j] = s.u1[j] = s.v1[j] = s.w1[j], s.y2[j] = s.u2[j] = s.v2[j] = s.w2[j];                          \
            }                                                                                                          \
            for (long done = 0; done < steps; done++) {                                                                \
                SIMD LANE {                                                                                            \
                    double d1, d2;                                                                                     \
                    name##_increment(b, s.m1[j], s.m2[j], s.y1[j], s.y2[j], &d1, &d2);                                 \
                    kahan(s.m1[j], s.k1[j], d1, &s.n1[j], &s.l1[j]);                                                   \
                    kahan(s.m2[j], s.k2[j], d2, &s.n2[j], &s.l2[j]);                                                   \
                    s.w1[j] = 3 * (s.y1[j] - s.u1[j]) + s.v1[j];                                                       \
                    s.w2[j] = 3 * (s.y2[j] - s.u2[j]) + s.v2[j];                                                       \
                }                                                                                                      \
                uncertain += name##_solve(b, &s);                                                                      \
                if (q) {                                                                                               \
                    SIMD LANE name##_move(s.y1[j], s.y2[j], &s.q0[j], &s.q1[j], &s.q2[j], &s.q3[j]);                   \
                }                                                                                                      \
                SIMD LANE {                                                                                            \
                    s.m1[j] = s.n1[j], s.m2[j] = s.n2[j], s.k1[j] = s.l1[j], s.k2[j] = s.l2[j];                        \
                    s.v1[j] = s.u1[j], s.v2[j] = s.u2[j], s.u1[j] = s.y1[j], s.u2[j] = s.y2[j];                        \
                    s.y1[j] = s.w1[j], s.y2[j] = s.w2[j];                                                              \
                }                                                                                                      \
            }                                                                                                          \
            LANE {                                                                                                     \
                m[2 * (first + j)] = s.m1[j], m[2 * (first + j) + 1] = s.m2[j];                                        \
                if (q) {                                                                                               \
                    double *pose = q + 4 * (first + j);                                                                \
                    pose[0] = s.q0[j], pose[1] = s.q1[j], pose[2] = s.q2[j], pose[3] = s.q3[j];                        \
                }                                                                                                      \
            }                                                                                                          \
        }                                                                                                              \
        return uncertain;                                                                                              \
    }

SYSTEM(top)
SYSTEM(sleigh)
