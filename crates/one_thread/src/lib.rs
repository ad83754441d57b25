//! What rasterlab uses of rayon, for a page: it has one thread, so these are plain iterators under
//! rayon's names. A method that rayon has and plain iterators lack is written here when it is needed.

/// Number of threads that share the work.
pub fn current_num_threads() -> usize {
    1
}

/// Traits with the methods of rayon's iterators.
pub mod prelude {
    use std::{iter, slice};

    /// Collections and iterators.
    pub trait IntoParallelIterator: IntoIterator + Sized {
        /// All items.
        fn into_par_iter(self) -> Self::IntoIter {
            self.into_iter()
        }
    }

    impl<I: IntoIterator> IntoParallelIterator for I {}

    /// The elements of a slice.
    pub trait ParallelSlice<T> {
        /// All elements.
        fn par_iter(&self) -> slice::Iter<'_, T>;
        /// All elements, to be written.
        fn par_iter_mut(&mut self) -> slice::IterMut<'_, T>;
        /// Runs of `length` elements, at least 1; the last one may be shorter.
        fn par_chunks(&self, length: usize) -> slice::Chunks<'_, T>;
        /// Runs of `length` elements, at least 1, to be written; the last one may be shorter.
        fn par_chunks_mut(&mut self, length: usize) -> slice::ChunksMut<'_, T>;
        /// Sorts the elements; the order of equal ones is not kept.
        fn par_sort_unstable(&mut self)
        where
            T: Ord;
    }

    impl<T> ParallelSlice<T> for [T] {
        fn par_iter(&self) -> slice::Iter<'_, T> {
            self.iter()
        }

        fn par_iter_mut(&mut self) -> slice::IterMut<'_, T> {
            self.iter_mut()
        }

        fn par_chunks(&self, length: usize) -> slice::Chunks<'_, T> {
            self.chunks(length)
        }

        fn par_chunks_mut(&mut self, length: usize) -> slice::ChunksMut<'_, T> {
            self.chunks_mut(length)
        }

        fn par_sort_unstable(&mut self)
        where
            T: Ord,
        {
            self.sort_unstable();
        }
    }

    /// What rayon's iterators have beside the methods of plain ones.
    pub trait ParallelIterator: Iterator + Sized {
        /// The same items: with one thread there is nothing to divide.
        fn with_min_len(self, _: usize) -> Self {
            self
        }

        /// The items of all that `each` gives.
        fn flat_map_iter<M: IntoIterator>(
            self,
            each: impl FnMut(Self::Item) -> M,
        ) -> impl Iterator<Item = M::Item> {
            self.flat_map(each)
        }

        /// All items joined by `join`; none of no items.
        fn reduce_with(
            self,
            join: impl FnMut(Self::Item, Self::Item) -> Self::Item,
        ) -> Option<Self::Item> {
            self.reduce(join)
        }
    }

    impl<I: Iterator> ParallelIterator for I {}

    /// An iterator that knows how many items it has.
    pub trait IndexedParallelIterator: ParallelIterator + ExactSizeIterator {
        /// Runs of `length` items, at least 1; the last one may be shorter.
        fn chunks(mut self, length: usize) -> impl Iterator<Item = Vec<Self::Item>> {
            iter::from_fn(move || {
                let run: Vec<_> = self.by_ref().take(length).collect();
                (!run.is_empty()).then_some(run)
            })
        }
    }

    impl<I: ExactSizeIterator> IndexedParallelIterator for I {}
}

#[cfg(test)]
mod tests {
    use super::prelude::*;

    #[test]
    fn items_come_in_their_order_and_all_of_them() {
        for count in [0, 1, 6, 7, 20] {
            let items = (0..count).into_par_iter().with_min_len(3);
            let runs: Vec<Vec<usize>> = items.chunks(7).collect();
            assert!(runs.iter().rev().skip(1).all(|run| run.len() == 7));
            let twice = runs.par_iter().flat_map_iter(|run| [run.as_slice(); 2]);
            assert!(twice.step_by(2).flatten().copied().eq(0..count), "{count}");
            assert_eq!(
                (0..count).into_par_iter().reduce_with(usize::max),
                count.checked_sub(1)
            );
        }
    }
}
