//! The distance to the nearest sample along a straight side, in one dimension. Its square is a lower envelope of
//! parabolas of equal opening, found with a stack. No triangulation is needed, so degenerate sets are no special case.

/// A sample seen from a line: its foot on the line and its distance from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BorderSite {
    pub foot: f64,
    pub offset: f64,
}

impl BorderSite {
    /// Distance from the place `at` on the line.
    pub fn distance(&self, at: f64) -> f64 {
        let along = at - self.foot;
        (along * along + self.offset * self.offset).sqrt()
    }

    /// The place on the line as far from this site as from `next`, whose foot is larger. Written about the
    /// middle so that the rounding is relative to the sites' separation.
    fn crossing(&self, next: &Self) -> f64 {
        let lift = (next.offset - self.offset) * (next.offset + self.offset);
        self.foot.midpoint(next.foot) + 0.5 * lift / (next.foot - self.foot)
    }
}

/// Where a Voronoi edge crosses the line, and how far the nearest samples are there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    pub at: f64,
    pub distance: f64,
    /// The two samples that are nearest there.
    pub sites: [BorderSite; 2],
}

/// Returns the crossings on the whole line, in order. Sorts `sites`.
pub(crate) fn crossings(sites: &mut [BorderSite]) -> Vec<Crossing> {
    sites.sort_unstable_by(|a, b| {
        (a.foot.total_cmp(&b.foot)).then_with(|| a.offset.total_cmp(&b.offset))
    });

    // Each kept site with the place from which on it is the nearest.
    let mut envelope: Vec<(BorderSite, f64)> = Vec::new();
    for site in sites.iter() {
        // Of sites with one foot the nearest came first and hides the others.
        if envelope
            .last()
            .is_some_and(|(last, _)| last.foot == site.foot)
        {
            continue;
        }

        // The new site is the nearest from its crossing with the last one on. Where that lies before the place from which
        // on the last one is the nearest, the last one is the nearest nowhere. If no site is left, the new one is the
        // nearest from the beginning of the line on.
        let mut from = f64::NEG_INFINITY;
        while let Some((last, last_from)) = envelope.last() {
            from = last.crossing(site);
            if from > *last_from {
                break;
            }
            envelope.pop();
            from = f64::NEG_INFINITY;
        }
        envelope.push((*site, from));
    }

    (envelope.windows(2))
        .map(|pair| {
            let ((before, _), (after, at)) = (pair[0], pair[1]);
            Crossing {
                at,
                distance: before.distance(at),
                sites: [before, after],
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn site(foot: f64, offset: f64) -> BorderSite {
        BorderSite { foot, offset }
    }

    #[test]
    fn two_sites_cross_once() {
        let found = crossings(&mut [site(4.0, 1.0), site(0.0, 1.0)]);
        let expected = Crossing {
            at: 2.0,
            distance: 5f64.sqrt(),
            sites: [site(0.0, 1.0), site(4.0, 1.0)],
        };
        assert_eq!(found, [expected]);
        let found = crossings(&mut [site(0.0, 0.0), site(2.0, 4.0)]);
        assert_eq!((found[0].at, found[0].distance), (5.0, 5.0));
    }

    #[test]
    fn hidden_sites_leave_no_crossing() {
        assert!(crossings(&mut []).is_empty());
        assert!(crossings(&mut [site(1.0, 2.0)]).is_empty());
        assert!(crossings(&mut [site(1.0, 2.0), site(1.0, 1.0)]).is_empty());
        let found = crossings(&mut [site(0.0, 0.0), site(1.0, 3.0), site(2.0, 0.0)]);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].at, 1.0);
    }

    /// Between and at the crossings the envelope is the minimum over all sites.
    #[test]
    fn crossings_bound_the_minimum_over_all_sites() {
        let pseudo = |i: u32, step: f64| (f64::from(i) * step).fract();
        let mut sites: Vec<BorderSite> = (1..60)
            .map(|i| site(pseudo(i, 0.618_034) * 10.0, pseudo(i, 0.754_877)))
            .collect();
        let found = crossings(&mut sites);
        let nearest = |at: f64| {
            (sites.iter())
                .map(|site| site.distance(at))
                .fold(f64::INFINITY, f64::min)
        };
        for crossing in &found {
            assert!((nearest(crossing.at) - crossing.distance).abs() < 1e-13);
        }
        let (first, last) = (found[0].at, found[found.len() - 1].at);
        let most = found.iter().map(|c| c.distance).fold(0.0, f64::max);
        let steps = (0..10_000).map(|i| first + (last - first) * f64::from(i) / 1e4);
        assert!(steps.map(nearest).fold(0.0, f64::max) <= most + 1e-13);
    }
}
