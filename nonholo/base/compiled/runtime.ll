; What code that numba compiled asks of its runtime: arrays, which are counted, and other shapes of arrays in C order.

declare double @llvm.sqrt.f64(double)
declare ptr @malloc(i64)
declare void @free(ptr)

define void @NRT_incref(ptr %block) {
  %none = icmp eq ptr %block, null
  br i1 %none, label %done, label %some
some:
  %count = load i64, ptr %block
  %more = add i64 %count, 1
  store i64 %more, ptr %block
  br label %done
done:
  ret void
}

define void @NRT_decref(ptr %block) {
  call void @nonholo_release(ptr %block)
  ret void
}

define ptr @NRT_MemInfo_alloc_aligned(i64 %size, i32 %align) {
  %whole = add i64 %size, 128
  %block = call ptr @malloc(i64 %whole)
  %none = icmp eq ptr %block, null
  br i1 %none, label %full, label %room
full:
  ret ptr null
room:
  %at = ptrtoint ptr %block to i64
  %over = add i64 %at, 127
  %begin = and i64 %over, -64
  %numbers = inttoptr i64 %begin to ptr
  %data = getelementptr i8, ptr %block, i64 24
  store i64 1, ptr %block
  store ptr %numbers, ptr %data
  ret ptr %block
}

define i64 @product(i64 %count, ptr %numbers) {
begin:
  br label %next
next:
  %k = phi i64 [ 0, %begin ], [ %after, %one ]
  %all = phi i64 [ 1, %begin ], [ %more, %one ]
  %done = icmp sge i64 %k, %count
  br i1 %done, label %end, label %one
one:
  %place = getelementptr i64, ptr %numbers, i64 %k
  %number = load i64, ptr %place
  %more = mul i64 %all, %number
  %after = add i64 %k, 1
  br label %next
end:
  ret i64 %all
}

define i32 @numba_attempt_nocopy_reshape(i64 %axes, ptr %shape, ptr %unused, i64 %others, ptr %other, ptr %strides, i64 %item, i32 %order) {
begin:
  br label %next
next:
  %left = phi i64 [ %others, %begin ], [ %k, %one ]
  %stride = phi i64 [ %item, %begin ], [ %wider, %one ]
  %done = icmp sle i64 %left, 0
  br i1 %done, label %end, label %one
one:
  %k = sub i64 %left, 1
  %place = getelementptr i64, ptr %strides, i64 %k
  store i64 %stride, ptr %place
  %from = getelementptr i64, ptr %other, i64 %k
  %length = load i64, ptr %from
  %wider = mul i64 %stride, %length
  br label %next
end:
  %before = call i64 @product(i64 %axes, ptr %shape)
  %after = call i64 @product(i64 %others, ptr %other)
  %same = icmp eq i64 %before, %after
  %answer = zext i1 %same to i32
  ret i32 %answer
}

define void @nonholo_release(ptr %block) {
  %none = icmp eq ptr %block, null
  br i1 %none, label %end, label %some
some:
  %count = load i64, ptr %block
  %less = sub i64 %count, 1
  store i64 %less, ptr %block
  %last = icmp eq i64 %less, 0
  br i1 %last, label %unused, label %end
unused:
  call void @free(ptr %block)
  br label %end
end:
  ret void
}

define ptr @NRT_MemInfo_alloc_safe_aligned(i64 %size, i32 %align) {
  %block = call ptr @NRT_MemInfo_alloc_aligned(i64 %size, i32 %align)
  ret ptr %block
}

define double @sqrt(double %x) {
  %root = call double @llvm.sqrt.f64(double %x)
  ret double %root
}
