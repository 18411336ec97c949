/// Rank of each of `count` places in an order of which every beginning is spread evenly over all places: that of the first multiples of the
/// golden section.
pub fn even_ranks(count: usize) -> Vec<usize> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let place = |rank: usize| (0.5 + rank as f64 * GOLDEN).fract();
    let mut ranks: Vec<usize> = (0..count).collect();
    ranks.sort_by(|a, b| place(*a).total_cmp(&place(*b)));
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_beginning_of_the_order_is_spread_over_the_places() {
        for count in [33, 75, 150] {
            let ranks = even_ranks(count);
            for kept in [count / 8, count / 3, count / 2] {
                let mean = (0..count).filter(|i| ranks[*i] < kept).sum::<usize>() as f64 / kept as f64;
                assert!((mean / (count as f64 - 1.0) - 0.5).abs() < 0.1, "{kept} of {count}: {mean}");
            }
        }
    }
}
