/* Hand-written reference of the discrete steps, to compare the compiled kernels of the library with.

   Build: cc -O3 -march=native -ffp-contract=fast -fno-math-errno -shared -fPIC steps.c -o steps.so -lm
   Momenta in units of the displacement, m = h r / 2 for tops and h (pi, p1) for the plane sleigh. */

#include <math.h>
#include <stddef.h>

static inline void kahan(double *total, double *lost, double term) {
    double change = term - *lost, result = *total + change;
    *lost = (result - *total) - change;
    *total = result;
}

/* Suslov top on SO(3): returns the number of good steps. Rows: momenta 2, charts 2, quaternions 4; NULL stores nothing. */
long suslov(const double *body, double *m, double *q, long steps, double *momenta, double *charts, double *poses) {
    const double b11 = body[0], b12 = body[1], b22 = body[2], c1 = body[3], c2 = body[4], certain = body[5];
    double m1 = m[0], m2 = m[1], k1 = 0, k2 = 0, y1 = 0, y2 = 0, u1 = 0, u2 = 0, v1 = 0, v2 = 0;
    double q0 = q[0], q1 = q[1], q2 = q[2], q3 = q[3];
    long done;
    for (done = -1; done < steps; done++) {
        double w1 = 0, w2 = 0;
        if (done >= 0) {
            double s = c2 * y1 - c1 * y2, push = 2 * s / (1 + y1 * y1 + y2 * y2);
            kahan(&m1, &k1, push * y2);
            kahan(&m2, &k2, -push * y1);
            w1 = 3 * (y1 - u1) + v1;
            w2 = 3 * (y2 - u2) + v2;
        }
        int good = 0;
        for (int i = 0; i < 8; i++) {
            double s = c2 * w1 - c1 * w2, weight = 1 + w1 * w1 + w2 * w2;
            double g1 = b11 * w1 + b12 * w2 - s * w2 - weight * m1, g2 = b12 * w1 + b22 * w2 + s * w1 - weight * m2;
            double j11 = b11 - c2 * w2 - 2 * w1 * m1, j12 = b12 + c1 * w2 - s - 2 * w2 * m1;
            double j21 = b12 + c2 * w1 + s - 2 * w1 * m2, j22 = b22 - c1 * w1 - 2 * w2 * m2;
            double inverse = 1 / (j11 * j22 - j12 * j21);
            double d1 = (j12 * g2 - j22 * g1) * inverse, d2 = (j21 * g1 - j11 * g2) * inverse;
            w1 += d1;
            w2 += d2;
            if (d1 * d1 + d2 * d2 <= 1e-18 * (1 + w1 * w1 + w2 * w2)) {
                good = 1;
                break;
            }
        }
        if (!good || !(w1 * w1 + w2 * w2 <= certain)) break;
        if (done >= 0) {
            double z0 = 1 / sqrt(1 + y1 * y1 + y2 * y2), x = -y2 * z0, y = y1 * z0;
            double r0 = q0 * z0 - q1 * x - q2 * y, r1 = q0 * x + q1 * z0 - q3 * y;
            double r2 = q0 * y + q2 * z0 + q3 * x, r3 = q3 * z0 + q1 * y - q2 * x;
            double unit = (3 - (r0 * r0 + r1 * r1 + r2 * r2 + r3 * r3)) / 2;
            q0 = r0 * unit, q1 = r1 * unit, q2 = r2 * unit, q3 = r3 * unit;
        }
        v1 = u1, v2 = u2, u1 = y1, u2 = y2, y1 = w1, y2 = w2;
        if (done < 0) u1 = v1 = y1, u2 = v2 = y2;
        if (momenta && done >= 0) {
            momenta[2 * done] = m1, momenta[2 * done + 1] = m2, charts[2 * done] = y1, charts[2 * done + 1] = y2;
            double *pose = poses + 4 * done;
            pose[0] = q0, pose[1] = q1, pose[2] = q2, pose[3] = q3;
        }
    }
    m[0] = m1, m[1] = m2, q[0] = q0, q[1] = q1, q[2] = q2, q[3] = q3;
    return done;
}

/* Chaplygin sleigh: body = (m, J, a). Rows: momenta (pi, p1), charts (t, y2), poses (cos, sin, x, y). */
long sleigh(const double *body, double *m, double *q, long steps, double *momenta, double *charts, double *poses) {
    const double mass = body[0], J = body[1], a = body[2], lever = mass * a * a;
    double pi = m[0], p1 = m[1], k1 = 0, k2 = 0, t = 0, t1 = 0, t2 = 0, slide = 0;
    double q0 = q[0], q1 = q[1], q2 = q[2], q3 = q[3];
    long done;
    for (done = -1; done < steps; done++) {
        double w = 0;
        if (done >= 0) {
            double change = 2 * t * t / (1 + t * t);
            double term = -2 * a * t * (p1 + a * mass * change);
            kahan(&pi, &k1, term);
            if (fabs(pi) < 1e-150 * fabs(p1)) pi = k1 = 0; /* settled: what is left would soon be denormal */
            kahan(&p1, &k2, 2 * a * mass * change);
            w = 3 * (t - t1) + t2;
        }
        double phat = a * p1 + 2 * lever;
        int good = 0;
        for (int i = 0; i < 12; i++) {
            double f = ((phat * w - pi) * w + 2 * J + phat) * w - pi;
            double d = -f / ((3 * phat * w - 2 * pi) * w + 2 * J + phat);
            w += d;
            if (d * d <= 1e-18 * (1 + w * w)) {
                good = 1;
                break;
            }
        }
        if (!good) break;
        if (done >= 0) {
            double z = 1 / (1 + t * t), c = (1 - t * t) * z, s = 2 * t * z, v = 2 * slide * z;
            double vx = v, vy = v * t;
            q2 += q0 * vx - q1 * vy;
            q3 += q1 * vx + q0 * vy;
            double n0 = q0 * c - q1 * s, n1 = q1 * c + q0 * s, unit = (3 - (n0 * n0 + n1 * n1)) / 2;
            q0 = n0 * unit, q1 = n1 * unit;
        }
        t2 = t1, t1 = t, t = w;
        slide = (p1 * (1 + t * t) + 2 * a * mass * t * t) / (2 * mass);
        if (done < 0) t1 = t2 = t;
        if (momenta && done >= 0) {
            momenta[2 * done] = pi, momenta[2 * done + 1] = p1, charts[2 * done] = t, charts[2 * done + 1] = slide;
            double *pose = poses + 4 * done;
            pose[0] = q0, pose[1] = q1, pose[2] = q2, pose[3] = q3;
        }
    }
    m[0] = pi, m[1] = p1, q[0] = q0, q[1] = q1, q[2] = q2, q[3] = q3;
    return done;
}

/* Top on SO(n) or sleigh on SE(n), k = n - 1 momenta, diagonal B; nothing stored. A top has arm 0, mass 1 and minus its
   coupling for c; blade is the momentum along the blade of a sleigh and its compensation. */
long wide(long k, const double *restrict b, const double *restrict c, double *restrict m, double *restrict lost,
          double mass, double arm, double *restrict blade, long steps) {
    const double lever = mass * arm * arm;
    double nu = lever, tau = 0, nu1 = 0, tau1 = 0, nu2 = 0, tau2 = 0;
    long done;
    for (done = -1; done < steps; done++) {
        double x = lever, t = 0;
        if (done >= 0) {
            double push = 2 / (1 + tau);
#pragma GCC ivdep
            for (long i = 0; i < k; i++) {
                double y = (m[i] + tau * (m[i] + c[i])) / (b[i] + nu);
                double change = push * (tau * c[i] - (nu - lever) * y) - lost[i], result = m[i] + change;
                lost[i] = (result - m[i]) - change;
                m[i] = result;
            }
            kahan(&blade[0], &blade[1], 2 * mass * arm * tau / (1 + tau));
            x = 3 * (nu - nu1) + nu2;
            t = fmax(3 * (tau - tau1) + tau2, 0);
        }
        const double q = arm * blade[0] + lever;
        int good = 0;
        for (int j = 0; j < 12; j++) {
            double cy = 0, yy = 0, cyr = 0, ce = 0, yyr = 0, ye = 0;
#pragma omp simd reduction(+ : cy, yy, cyr, ce, yyr, ye)
            for (long i = 0; i < k; i++) {
                double r = 1 / (b[i] + x), pushed = m[i] + c[i], y = (m[i] + t * pushed) * r, e = pushed * r;
                cy += c[i] * y;
                yy += y * y;
                cyr += c[i] * y * r;
                ce += c[i] * e;
                yyr += y * y * r;
                ye += y * e;
            }
            double f1 = x - cy - (1 + t) * q, f2 = t - yy, j11 = 1 + cyr, j12 = -ce - q, j21 = 2 * yyr, j22 = 1 - 2 * ye;
            double det = j11 * j22 - j12 * j21, d1 = (j12 * f2 - j22 * f1) / det, d2 = (j21 * f1 - j11 * f2) / det;
            x += d1;
            t += d2;
            if (!(det > 0)) break;
            if (d1 * d1 <= 1e-18 && d2 * d2 <= 1e-18 * fabs(t)) {
                good = 1;
                break;
            }
        }
        if (!good) break;
        nu2 = nu1, tau2 = tau1, nu1 = nu, tau1 = tau, nu = x, tau = t;
        if (done < 0) nu1 = nu2 = nu, tau1 = tau2 = tau;
    }
    return done;
}
